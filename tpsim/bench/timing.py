"""How the benchmarks take time."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from statistics import median
from time import perf_counter


def median_time(call: Callable[[], object], repetitions: int) -> float:
    """Median wall time of a call [s], after one call that does not count."""
    call()
    times = []
    for _ in range(repetitions):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return median(times)


def one_core() -> AbstractContextManager:
    """Keep linear algebra on one core, where threadpoolctl (of scikit-learn) is installed."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        return nullcontext()
    return threadpool_limits(1)
