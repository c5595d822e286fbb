"""One set of processes for a whole job: what they have imported serves all of its parts."""

from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any

from tpsim.study.workers import processes, shut_down


class Lender:
    """Makes executors that share the same processes; a context that ends them.

    Give it to :class:`~tpsim.study.workers.Workers` as ``executor``, one after the other. Where a
    worker dies all processes are made anew.

    Parameters
    ----------
    count : int
        Processes.
    """

    def __init__(self, count: int):
        self._count = count
        self._processes: Executor | None = None

    def __enter__(self) -> "Lender":
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        self.end()

    def __call__(self, count: int) -> Executor:
        """An executor, whatever ``count`` is: fewer than all may be used at a time."""
        if self._processes is None:
            self._processes = processes(self._count)
        return _Lent(self, self._processes)

    def end(self) -> None:
        """End the processes, if there are any."""
        lent, self._processes = self._processes, None
        if lent is not None:
            shut_down(lent, at_once=True)


class _Lent(Executor):
    """Processes of a lender, which outlive it unless they are to be killed."""

    def __init__(self, lender: Lender, lent: Executor):
        self._lender, self._lent = lender, lent

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future:
        """As the lent executor does."""
        return self._lent.submit(fn, *args, **kwargs)

    def shutdown(
        self, wait: bool = True, *, cancel_futures: bool = False, kill_workers: bool = False
    ) -> None:
        """Give the processes back; with ``kill_workers`` nobody gets them again."""
        if kill_workers:
            self._lender.end()
