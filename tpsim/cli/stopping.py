"""Signals that end a command: Ctrl-C, an end that was asked for, a terminal that went away.

The first one ends the work in order: workers are killed, what is half written is removed, one line
says how to start again. The second, or a first that was not heard in time, ends the process at
once; its workers notice. Nothing heavy is imported here: the sooner it listens, the better.
"""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from tpsim import driver

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")

GRACE = 3.0
"""Time [s] that the work has to end in order."""

_first: int | None = None
_timer: threading.Timer | None = None
_told = False


class Stopped(KeyboardInterrupt):
    """Raised where the work is when one of the signals comes."""


@contextmanager
def listening(for_good: bool) -> Iterator[None]:
    """End what is done in this block in order when one of the signals comes.

    Signals that are ignored, as under nohup, stay ignored. Afterwards they do what they did before
    or, where this is for good, end the process at once.
    """
    global _first, _told
    _first, _told = None, False
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in (getattr(signal, name) for name in NAMES if hasattr(signal, name)):
            if signal.getsignal(number) != signal.SIG_IGN:
                before[number] = signal.signal(number, _stop)
    hook, sys.unraisablehook = sys.unraisablehook, _not_raised
    try:
        yield
    finally:
        sys.unraisablehook = hook
        if _timer is not None and not for_good:
            _timer.cancel()
        for number, handler in before.items():
            signal.signal(number, _end if for_good else handler)


def stopped() -> bool:
    """Whether one of the signals came: whatever is raised then is a consequence."""
    return _first is not None


def tell(error: BaseException, again: str) -> int:
    """Say in one line what happened and how to start again; return the exit code."""
    global _told
    _abandon()
    kept = (
        "; ".join(getattr(error, "__notes__", [])) if isinstance(error, KeyboardInterrupt) else ""
    )
    if not _told:
        _told = True
        with suppress(OSError):  # the terminal may be gone
            line = f"tpsim: {_word()}{kept and '; ' + kept}. To start again: {again}"
            print(line, file=sys.stderr, flush=True)
            sys.stdout.flush()
    return _code()


def _abandon() -> None:
    """Remove what is half written, also where a signal came while it was being removed."""
    if whole := sys.modules.get("tpsim.whole"):
        whole.abandon()


def _word() -> str:
    name = signal.Signals(_first or signal.SIGINT).name
    return "interrupted" if name == "SIGINT" else f"ended by {name}"


def _code() -> int:
    return 128 + (_first or signal.SIGINT)


def _stop(number: int, _: FrameType | None) -> None:
    global _first, _timer
    if _first is not None:
        _leave()
    _first = number
    # Some code catches everything, and some loops hear nothing.
    _timer = threading.Timer(GRACE, _leave)
    _timer.daemon = True
    _timer.start()
    raise Stopped


def _end(number: int, _: FrameType | None) -> None:
    """What signals do when all is done, and Python ends."""
    os._exit(128 + (_first or number))


def _not_raised(about: "sys.UnraisableHookArgs") -> None:
    """Python cannot raise where it collects garbage; a signal that came there counts too."""
    if isinstance(about.exc_value, Stopped):
        _leave()
    sys.__unraisablehook__(about)


def _leave() -> None:
    """End this process now, and those that it started."""
    driver.end_others()
    _abandon()
    if not _told:
        with suppress(OSError):
            # Printing may be what it was doing.
            os.write(2, f"tpsim: {_word()} at once; what was not finished is lost\n".encode())
    os._exit(_code())
