"""Dask as processes: a worker and a scheduler are killed, and no trial is lost or done twice."""

import os
import signal
import subprocess
import sys
import threading
import time

import pytest

from tpsim.campaign import cluster
from tpsim.campaign.cluster import dask
from tpsim.campaign.run import campaign
from tpsim.errors import SimulationError

from .test_run import begun, rows

pytest.importorskip("distributed")

assert begun


def start(*words):
    line = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *map(str, words[1:])]
    silent = subprocess.DEVNULL
    return subprocess.Popen(line, stdout=silent, stderr=silent)


@pytest.fixture
def there(tmp_path):
    """A scheduler and two workers: its address, its process and theirs."""
    file = tmp_path / "scheduler.json"
    scheduler = start(
        "scheduler", "--port", 0, "--no-dashboard", "--scheduler-file", file, "--host", "127.0.0.1"
    )
    common = ("--scheduler-file", file, "--nthreads", 1, "--no-nanny", "--no-dashboard")
    workers = [start("worker", *common, "--death-timeout", 30) for _ in range(2)]
    from distributed import Client

    with Client(scheduler_file=str(file), timeout=60) as client:
        client.wait_for_workers(2, timeout=60)
        address = client.scheduler.address
    yield address, scheduler, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait(10)


def when_working(address, act):
    """Do something as soon as a worker has work."""

    def look():
        from distributed import Client

        with Client(address, set_as_default=False) as client:
            while not any(client.processing().values()):
                time.sleep(0.02)
            busy = [worker for worker, tasks in client.processing().items() if tasks]
            pids = client.run(os.getpid, workers=busy)
            act(next(iter(pids.values())))

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    return thread


def test_a_dead_worker_and_a_dead_scheduler_cost_time_only(
    there, described, undisturbed, begun, monkeypatch
):
    address, scheduler, workers = there
    with dask(address, 1) as (executor, count):
        assert count == 2
        killed = when_working(address, lambda pid: os.kill(pid, signal.SIGKILL))
        answer = campaign(described, begun, workers=count, executor=executor)
        killed.join(10)
    assert sum(worker.poll() is None for worker in workers) == 1
    assert (answer["performed"], answer["digest"]) == (26, undisturbed[0]["digest"])
    assert rows(begun) == rows(undisturbed[1])

    (begun / "table.parquet").unlink()
    for file in (begun / "table").rglob("block-*"):
        file.unlink()
    monkeypatch.setattr(cluster, "PATIENCE", 2.0)
    with (
        pytest.raises(SimulationError, match=r"scheduler is gone .*run the same command"),
        dask(address, 1) as (executor, count),
    ):
        killed = when_working(address, lambda _: scheduler.kill())
        campaign(described, begun, workers=count, executor=executor)
    again = campaign(described, begun)
    assert (again["done"], again["digest"]) == (26, undisturbed[0]["digest"])


def test_a_scheduler_that_is_not_there_is_said(monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with (
        pytest.raises(SimulationError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"),
        dask("tcp://127.0.0.1:9", 1),
    ):
        pass
