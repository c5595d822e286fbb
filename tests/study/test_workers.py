import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from tpsim.errors import ArgumentError
from tpsim.study.lending import Lender
from tpsim.study.workers import Death, Workers


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


def answers(make, given, count=2):
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


def sometimes_deadly(folder):
    """Argument 1 ends its worker once, argument 4 always."""

    def apply(x):
        if x == 4 or (x == 1 and not (folder / "died").exists()):
            (folder / "died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return x

    return apply


def test_a_death_costs_time_only_and_a_second_one_is_a_line(tmp_path):
    with Workers(2, sometimes_deadly, tmp_path) as workers:
        results = list(workers.map(range(7)))
    assert results[:4] + results[5:] == [0, 1, 2, 3, 5, 6]
    assert results[4] == Death("signal 9")
    assert "\n" not in str(results[4]) and "fewer workers" in str(results[4])


def test_any_executor_will_do():
    """Also one that works here, in threads."""
    with Workers(2, slow_then_fast, 10, ThreadPoolExecutor) as workers:
        assert [value for value, _ in workers.map(range(5))] == [0, 10, 20, 30, 40]


def test_few_results_wait_for_a_slow_one(tmp_path):
    """Memory does not grow with the number of arguments."""

    def make(folder):
        def apply(x):
            if x == 0:
                time.sleep(0.5)
            return (folder / str(x)).touch()

        return apply

    with Workers(2, make, tmp_path, ThreadPoolExecutor) as workers:
        next(workers.map(range(100)))
        assert len(list(tmp_path.iterdir())) <= 10


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

    with Workers(2, make, None) as workers:
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


def told(factor):
    return lambda x: (factor * x, os.getpid())


def dying(_):
    return lambda x: os.kill(os.getpid(), signal.SIGKILL) if x else os.getpid()


def test_the_same_processes_serve_one_function_after_the_other_and_end_with_the_lender():
    seen = []
    with Lender(2) as lender:
        for factor in (10, 3):
            with Workers(2, told, factor, lender) as workers:
                results = list(workers.map(range(6)))
            assert [value for value, _ in results] == [factor * x for x in range(6)]
            seen.append({pid for _, pid in results})
    assert seen[0] | seen[1] == seen[0] and os.getpid() not in seen[0]
    assert all(gone(pid) for pid in seen[0])


def test_a_worker_that_dies_is_replaced_for_those_who_come_after():
    with Lender(2) as lender:
        with Workers(2, dying, None, lender) as workers:
            first, lost = list(workers.map([0, 1]))
        assert isinstance(lost, Death)
        with Workers(2, told, 2, lender) as workers:
            (value, pid), *_ = list(workers.map([4, 5]))
        assert value == 8 and pid != first
    assert gone(pid)


def test_an_error_ends_all_processes_at_once():
    pids = []
    with pytest.raises(KeyboardInterrupt), Lender(2) as lender:
        with Workers(2, told, 1, lender) as workers:
            pids = [pid for _, pid in workers.map(range(4))]
        raise KeyboardInterrupt
    assert all(gone(pid) for pid in pids)


def test_the_end_waits_for_no_worker():
    """One that holds the lock of the queue, or does not go for another reason, is killed."""
    with Lender(2) as lender:
        with Workers(2, slow_then_fast, 1, lender) as workers:
            (_, stuck), *_ = workers.map(range(4))
        os.kill(stuck, signal.SIGSTOP)
        # Asked to go, it would go then.
        wakes = threading.Timer(8.0, os.kill, (stuck, signal.SIGCONT))
        wakes.start()
        began = time.monotonic()
    took = time.monotonic() - began
    wakes.cancel()
    assert took < 4.0 and gone(stuck)
