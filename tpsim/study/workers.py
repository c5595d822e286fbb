"""Work for executors: one function applied to many arguments, here or in processes.

One worker is this process; more are any :class:`concurrent.futures.Executor`, loky's by default.
What they are given travels by value, what they return comes in order. A worker that dies costs
nothing but time: what it was doing is done again, alone, and only what ends its worker a second
time is given up.
"""

import inspect
import io
import os
import pickle
import re
import signal
import sys
import traceback
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

import cloudpickle

from tpsim.driver import end_with
from tpsim.errors import SimulationError, TpsimError, one_line, place
from tpsim.film.rendering import name_glfw

G = TypeVar("G")
A = TypeVar("A")
B = TypeVar("B")

_AHEAD = 4
"""Results for each worker that may wait for one before them: memory does not grow with the work."""

_WARNINGS = "PYTHONWARNINGS"


@dataclass(frozen=True)
class Death:
    """That an argument ended its worker twice: it comes in the place of a result.

    Parameters
    ----------
    reason : str
        What ended the worker, such as ``"signal 9"``.
    """

    reason: str

    def __str__(self) -> str:
        """Return a line for people."""
        return (
            f"it ended its worker process twice ({self.reason}): it was killed, or there was no "
            "memory left; try again with fewer workers"
        )


def processes(count: int) -> Executor:
    """Executor of fresh processes, which end with this one and leave Ctrl-C to it."""
    # Importing it takes a while, and what runs in one process does without.
    from loky import ProcessPoolExecutor

    class Killed(ProcessPoolExecutor):  # type: ignore[misc]
        """Its end kills the workers: asked to go, one would wait for ever for another's lock.

        They write under temporary names, so that nothing is half. A worker that dies while it
        looks for work keeps the lock of the queue.
        """

        def shutdown(self, wait: bool = True, kill_workers: bool = True) -> None:
            super().shutdown(wait=wait, kill_workers=True)

    name_glfw()
    with _deaf():
        return Killed(
            count,
            timeout=None,
            initializer=end_with,
            initargs=(os.getpid(),),
            # A crash is told in one line; empty is off for Python and for loky.
            env={"PYTHONFAULTHANDLER": ""},
        )


Executors = Callable[[int], Executor]
"""Makes an executor of so many workers."""


class Workers(Generic[A, B]):
    """Applies one function to many arguments; a context that ends its processes.

    Parameters
    ----------
    count : int
        Processes; with 1 all is done in this one, unless an executor is given.
    make : callable
        ``make(given)`` makes the function, once in every worker.
    given : object
        Sent by value with cloudpickle: functions of a user's file or notebook may be in it.
    apart : bool
        Whether one worker, too, is a process of its own, so that this one has its hands free.
    executor : callable, optional
        Makes an executor of so many workers, and a new one when it broke; :func:`processes` by
        default, where there are several.
    """

    def __init__(
        self,
        count: int,
        make: Callable[[G], Callable[[A], B]],
        given: G,
        executor: Executors | None = None,
        *,
        apart: bool = False,
    ):
        self._count, self._new = count, executor or processes
        self._here = count == 1 and executor is None and not apart
        self._make, self._given = make, given
        self._executor: Executor | None = None

    def __enter__(self) -> "Workers[A, B]":
        if not self._here:
            self._packed = _by_value((self._make, self._given))
            self._executor = self._new(self._count)
        else:
            self._function = self._make(self._given)
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        self._end(at_once=kind is not None)

    def map(self, arguments: Sequence[A]) -> Iterator[B | Death]:
        """Results in the order of the arguments; a :class:`Death` for what ended its worker twice.

        What the function raises is raised here.
        """
        if self._here:
            yield from map(self._function, arguments)
            return
        waiting = deque(range(len(arguments)))
        running: dict[Future, int] = {}
        done: dict[int, B | Death] = {}
        for index in range(len(arguments)):
            while index not in done:
                while waiting and len(running) < self._count and self._near(waiting[0], index):
                    self._give(running, waiting.popleft(), arguments)
                wait(running, return_when=FIRST_COMPLETED)
                if suspects := _collect(running, done):
                    self._again(suspects, arguments, done)
            yield done.pop(index)

    def _near(self, number: int, index: int) -> bool:
        return number < index + _AHEAD * self._count

    def _give(self, running: dict[Future, int], number: int, arguments: Sequence[A]) -> None:
        assert self._executor is not None
        future: Future
        try:
            with _deaf():
                future = self._executor.submit(_apply, self._packed, _by_value(arguments[number]))
        except BrokenExecutor as error:
            future = Future()
            future.set_exception(error)
        running[future] = number

    def _again(
        self, suspects: list[int], arguments: Sequence[A], done: dict[int, B | Death]
    ) -> None:
        """Do again, one after the other, what was being done when a worker died."""
        self._renew()
        for number in sorted(suspects):
            alone: dict[Future, int] = {}
            self._give(alone, number, arguments)
            (future,) = alone
            try:
                done[number] = _result(future)
            except BrokenExecutor as error:
                done[number] = Death(_how(error))
                self._renew()

    def _renew(self) -> None:
        self._end(at_once=True)
        self._executor = self._new(self._count)

    def _end(self, *, at_once: bool) -> None:
        executor, self._executor = self._executor, None
        if executor is not None:
            shut_down(executor, at_once=at_once)


def shut_down(executor: Executor, *, at_once: bool) -> None:
    """End an executor; ``at_once`` kills its workers, where it can do so."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if at_once and "kill_workers" in inspect.signature(executor.shutdown).parameters:
            executor.shutdown(kill_workers=True)  # type: ignore[call-arg]
        else:
            executor.shutdown()


def _collect(running: dict[Future, int], done: dict) -> list[int]:
    """Take out what is done; return what was running in an executor that is broken."""
    finished = [future for future in running if future.done()]
    suspects = []
    for future in finished:
        number = running.pop(future)
        try:
            done[number] = _result(future)
        except BrokenExecutor:
            suspects.append(number)
    if suspects:
        # The executor fails all that it has.
        wait(running)
        suspects += _collect(running, done)
    return suspects


def _result(future: Future):  # type: ignore[no-untyped-def]
    result, error = pickle.loads(future.result())
    if error is not None:
        raise error
    return result


def _how(error: BrokenExecutor) -> str:
    """Which signal or exit code ended a worker, out of loky's paragraphs."""
    found = re.search(r"\{(?:\w+\()?(-?\d+)\)?[,}]", str(error))
    if found is None:
        return one_line(error)[:100]
    code = int(found[1])
    return f"signal {-code}" if code < 0 else f"exit code {code}"


class _Pickler(cloudpickle.Pickler):  # type: ignore[misc]
    """Leaves out what msgspec remembers of a class: it cannot travel."""

    def reducer_override(self, obj: object) -> object:
        if isinstance(obj, type) and "__msgspec_cache__" in vars(obj):
            del obj.__msgspec_cache__  # type: ignore[attr-defined]
        return super().reducer_override(obj)


def _by_value(value: object) -> bytes:
    buffer = io.BytesIO()
    _Pickler(buffer).dump(value)
    return buffer.getvalue()


@contextmanager
def _deaf() -> Iterator[None]:
    """Start processes that leave Ctrl-C, and a terminal that goes away, to this one."""
    # A blocked signal is inherited; one that comes meanwhile is delivered afterwards.
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
    told = os.environ.get(_WARNINGS)
    # Who tidies up after a driver that was killed does so without paragraphs.
    os.environ[_WARNINGS] = ",".join(filter(None, [told, "ignore:resource_tracker"]))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if told is None:
            del os.environ[_WARNINGS]
        else:
            os.environ[_WARNINGS] = told


@lru_cache(1)
def _made(packed: bytes) -> Callable:
    make, given = pickle.loads(packed)
    function: Callable = make(given)
    return function


def _apply(packed: bytes, argument: bytes) -> bytes:
    """Apply the function, made at the first time, to an argument."""
    try:
        with redirect_stdout(sys.stderr):  # the driver's answer is alone on its own
            return cloudpickle.dumps((_made(packed)(pickle.loads(argument)), None))
    except Exception as error:
        return _packed_error(error)


def _packed_error(error: Exception) -> bytes:
    """An error that can travel; what is no error of tpsim keeps where it happened as a note."""
    if not isinstance(error, TpsimError):
        error.add_note("in a worker process:\n" + "".join(traceback.format_exception(error)))
        error.place = place(error)  # type: ignore[attr-defined]
    try:
        pickle.loads(packed := cloudpickle.dumps((None, error)))
    except Exception:
        said = SimulationError(f"{type(error).__name__} in a worker process: {error}")
        packed = pickle.dumps((None, said))
    return packed
