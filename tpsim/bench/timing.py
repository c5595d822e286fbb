"""How the benchmarks take time."""

from collections.abc import Callable
from statistics import median
from time import perf_counter, process_time


def median_time(
    call: Callable[[], object], repetitions: int, clock: Callable[[], float] = perf_counter
) -> float:
    """Median wall time of a call [s], after one call that does not count."""
    call()
    times = []
    for _ in range(repetitions):
        start = clock()
        call()
        times.append(clock() - start)
    return median(times)


def processor_time(call: Callable[[], object], repetitions: int) -> float:
    """Median processor time of a call [s], after one call that does not count."""
    return median_time(call, repetitions, process_time)
