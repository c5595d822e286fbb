import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

from tpsim.errors import ArgumentError, SimulationError
from tpsim.study.workers import Workers


def slow_then_fast(factor):
    """Makes later arguments ready first."""

    def apply(x):
        time.sleep(0.05 * (4 - x))
        return factor * x, os.getpid()

    return apply


def failing(kind):
    def apply(x):
        if kind == "tpsim":
            raise ArgumentError("give something else")
        if kind == "foreign":
            return 1 / 0
        os.kill(os.getpid(), signal.SIGKILL)

    return apply


def broken(_):
    raise ArgumentError("cannot be made")


def gone(pid):
    """Whether a process ends within a while."""
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


def test_results_come_in_order_and_the_workers_end():
    with Workers(2, slow_then_fast, 10) as workers:
        results = list(workers.map(range(5)))
    assert [value for value, _ in results] == [0, 10, 20, 30, 40]
    pids = {pid for _, pid in results}
    assert len(pids) == 2 and os.getpid() not in pids
    assert all(gone(pid) for pid in pids)


def answers(make, given, count=1):
    with Workers(count, make, given) as workers:
        return list(workers.map(range(3)))


def test_what_a_worker_raises_is_raised_here():
    with pytest.raises(ArgumentError, match="give something else"):
        answers(failing, "tpsim")
    with pytest.raises(ZeroDivisionError) as error:
        answers(failing, "foreign")
    assert "in apply" in error.value.__notes__[0]
    with pytest.raises(ArgumentError, match="cannot be made"):
        answers(broken, 0)


def test_a_death_is_one_line():
    with pytest.raises(SimulationError, match=r"worker process died .signal 9.: .*fewer") as error:
        answers(failing, "death", 2)
    assert "\n" not in str(error.value)


SCRIPT = """
    import os, signal, sys, time
    from tpsim.study.workers import Workers

    # Shells start what runs in the background deaf to SIGINT.
    signal.signal(signal.SIGINT, signal.default_int_handler)

    def make(_):
        def apply(x):
            if x:
                time.sleep(60)
            return os.getpid()
        return apply

    with Workers(1, make, None) as workers:
        print(*workers.map([0]), flush=True)
        list(workers.map([1]))
"""


@pytest.mark.parametrize(
    "how", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL], ids=lambda how: how.name
)
def test_no_worker_outlives_its_driver(tmp_path, how):
    """A script without a main guard, ended at work by any signal."""
    file = tmp_path / "script.py"
    file.write_text(textwrap.dedent(SCRIPT))
    driver = subprocess.Popen(
        [sys.executable, file], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    worker = int(driver.stdout.readline())
    driver.send_signal(how)
    _, said = driver.communicate(timeout=30)
    assert driver.returncode != 0
    assert gone(worker)
    assert "Process" not in said
