"""Dask as processes: a worker and a scheduler are killed, and no trial is lost or done twice."""

import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace

import pytest
from distributed import Client

from tpsim.campaign import cluster
from tpsim.campaign.cluster import dask
from tpsim.campaign.run import campaign
from tpsim.errors import SimulationError
from tpsim.study.reference import load_study

from .test_run import begun, rows

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
    workers = [start("worker", *common, "--death-timeout", 180) for _ in range(2)]
    with Client(scheduler_file=str(file), timeout=180) as client:
        client.wait_for_workers(2, timeout=180)
        address = client.scheduler.address
    yield address, scheduler, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait(10)


def when_working(client, act):
    """Do something as soon as a worker has work."""

    def look():
        while not (busy := [name for name, tasks in client.processing().items() if tasks]):
            time.sleep(0.02)
        act(pids[busy[0]])

    pids = client.run(os.getpid)
    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    return thread


def slowly(reference):
    """The study with a controller that takes its time; the bits are the same."""
    study = load_study(reference)
    still = study.controllers["still"]

    def controller(world, models, situation):
        time.sleep(0.2)
        return still(world, models, situation)

    return replace(study, controllers={**study.controllers, "still": controller})


def test_a_dead_worker_and_a_dead_scheduler_cost_time_only(there, described, undisturbed, begun):
    address, scheduler, workers = there
    client = Client(address, set_as_default=False)
    slow = slowly(described.study)
    with dask(address, 1) as (executor, count):
        assert count == 2
        killed = when_working(client, lambda pid: os.kill(pid, signal.SIGKILL))
        answer = campaign(described, begun, workers=count, executor=executor, study=slow)
        killed.join(10)
    assert sum(worker.poll() is None for worker in workers) == 1
    assert (answer["performed"], answer["digest"]) == (26, undisturbed[0]["digest"])
    assert rows(begun) == rows(undisturbed[1])

    (begun / "table.parquet").unlink()
    for file in (begun / "table").rglob("block-*"):
        file.unlink()
    with (
        pytest.raises(SimulationError, match=r"scheduler is gone .*run the same command"),
        dask(address, 1) as (executor, count),
    ):
        when_working(client, lambda _: scheduler.kill())
        campaign(described, begun, workers=count, executor=executor, study=slow)
    again = campaign(described, begun)
    assert (again["done"], again["digest"]) == (26, undisturbed[0]["digest"])


def test_a_scheduler_that_is_not_there_is_said(monkeypatch):
    monkeypatch.setattr(cluster, "PATIENCE", 0.5)
    with (
        pytest.raises(SimulationError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"),
        dask("tcp://127.0.0.1:9", 1),
    ):
        pass
