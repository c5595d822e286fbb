"""Worker processes: what they are given travels by value, what they return comes in order.

Every worker has a pipe of its own, which says when the other side is gone.
"""

import io
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from types import ModuleType
from typing import Generic, TypeVar, cast

import cloudpickle

from tpsim.errors import SimulationError, TpsimError

G = TypeVar("G")
A = TypeVar("A")
B = TypeVar("B")

_PATIENCE = 2.0
"""Time [s] that a worker has to end before it is killed."""


class Workers(Generic[A, B]):
    """Processes that apply one function to many arguments; a context that ends them.

    Parameters
    ----------
    count : int
    make : callable
        ``make(given)`` makes the function, once in every worker.
    given : object
        Sent by value with cloudpickle: functions of a user's file or notebook may be in it.
    """

    def __init__(self, count: int, make: Callable[[G], Callable[[A], B]], given: G):
        self._packed = _by_value((make, given))
        self._count = count
        self._processes: list[tuple[multiprocessing.process.BaseProcess, Connection]] = []

    def __enter__(self) -> "Workers[A, B]":
        # Fresh processes inherit no threads, locks or renderers.
        context = multiprocessing.get_context("spawn")
        with _quiet_start():
            for _ in range(self._count):
                ours, theirs = context.Pipe()
                process = context.Process(target=_work, args=(theirs,), daemon=True)
                process.start()
                theirs.close()
                self._processes.append((process, ours))
        return self

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        for process, pipe in self._processes:
            pipe.close()
            if kind is not None:
                process.terminate()
        for process, _ in self._processes:
            process.join(_PATIENCE)
            if process.is_alive():
                process.kill()
                process.join()

    def map(self, arguments: Sequence[A]) -> Iterator[B]:
        """Results in the order of the arguments.

        Raises
        ------
        SimulationError
            If a worker dies. What a worker raises is raised here.
        """
        waiting = iter(enumerate(arguments))
        busy: dict[Connection, int] = {}
        done: dict[int, B] = {}
        for _, pipe in self._processes:
            self._send(pipe, self._packed)
            self._give(pipe, waiting, busy)
        for index in range(len(arguments)):
            while index not in done:
                for pipe in cast(list[Connection], wait(list(busy))):
                    number = busy.pop(pipe)
                    done[number] = self._receive(pipe)
                    self._give(pipe, waiting, busy)
            yield done.pop(index)

    def _give(
        self, pipe: Connection, waiting: Iterator[tuple[int, A]], busy: dict[Connection, int]
    ) -> None:
        for number, argument in waiting:
            self._send(pipe, _by_value(argument))
            busy[pipe] = number
            return

    def _send(self, pipe: Connection, packed: bytes) -> None:
        try:
            pipe.send_bytes(packed)
        except OSError:
            raise self._death(pipe) from None

    def _receive(self, pipe: Connection) -> B:
        try:
            result, error = pickle.loads(pipe.recv_bytes())
        except (EOFError, OSError):
            raise self._death(pipe) from None
        if error is not None:
            raise error
        return cast(B, result)

    def _death(self, pipe: Connection) -> SimulationError:
        process = next(p for p, ours in self._processes if ours is pipe)
        process.join(_PATIENCE)
        code = process.exitcode
        how = f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return SimulationError(
            f"a worker process died ({how}): it was killed, or there was no memory left; "
            "try again with fewer workers"
        )


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
def _quiet_start() -> Iterator[None]:
    """Start workers that leave Ctrl-C to the driver, and do not run the user's script again."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    # A blocked signal is inherited; one that comes meanwhile is delivered afterwards.
    can_block = hasattr(signal, "pthread_sigmask")
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if can_block else set()
    try:
        yield
    finally:
        sys.modules["__main__"] = script
        if can_block:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _work(pipe: Connection) -> None:
    """Apply the function until the driver closes the pipe."""
    threading.Thread(target=_end_with_driver, daemon=True).start()
    try:
        packed, apply = pipe.recv_bytes(), None
        while True:
            argument = pipe.recv_bytes()
            try:
                if apply is None:
                    make, given = pickle.loads(packed)
                    apply = make(given)
                answer = cloudpickle.dumps((apply(pickle.loads(argument)), None))
            except Exception as error:
                answer = _packed_error(error)
            pipe.send_bytes(answer)
    except (EOFError, OSError):
        # The driver is gone, or has all that it wants.
        os._exit(0)


def _end_with_driver() -> None:
    """A driver that is killed cannot end its workers."""
    driver = multiprocessing.parent_process()
    assert driver is not None
    driver.join()
    os._exit(1)


def _packed_error(error: Exception) -> bytes:
    """An error that can travel; what is no error of tpsim keeps its traceback as a note."""
    if not isinstance(error, TpsimError):
        error.add_note("in a worker process:\n" + "".join(traceback.format_exception(error)))
    try:
        packed = cloudpickle.dumps((None, error))
        pickle.loads(packed)
    except Exception:
        reason = f"{type(error).__name__} in a worker process: {error}"
        packed = pickle.dumps((None, SimulationError(reason)))
    return packed
