"""One hostile call, and what became of it."""

import dataclasses
import signal
import warnings
from collections import namedtuple
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from tpsim.errors import DataWarning, TpsimError

LIMIT = 2.0
"""Time [s] of the processor that a call may take."""

HANG = 30.0
"""Time [s] of the wall clock after which a call hangs."""

GOOD = ("fine", "refused")

Verdict = namedtuple("Verdict", ["kind", "words"])
"""``fine`` or ``refused``, or what is wrong, and in which words."""


class TooSlow(BaseException):
    """Raised by the alarm: no ``except Exception`` catches it."""


def judge(
    call: Callable[..., object],
    arguments: Mapping[str, object],
    corrupted: Mapping[str, bool],
    infinite: bool = False,
    keeps: tuple[str, ...] = (),
    words: tuple[str, ...] = (),
) -> Verdict:
    """Call, and say what became of it.

    Parameters
    ----------
    call, arguments
        What is called, with what.
    corrupted : mapping of str to bool
        The arguments that are hostile, and whether they are nonsense that must be refused.
    infinite : bool
        Whether the answer may hold infinities.
    keeps : tuple of str
        Arguments that the answer documents to hold as they are, whatever they are.
    words : tuple of str
        Other names of the arguments.
    """
    before = [(array, array.copy()) for array in arrays_in(list(arguments.values()))]
    plain = [(part, len(part)) for part in containers_in(list(arguments.values()))]
    given = [array for name, part in arguments.items() if name not in keeps
             for array in raw_arrays(part)]  # fmt: skip
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            with time_limit():
                answer = call(**arguments)
                answers = list(arrays_in([answer]))
        except TpsimError as error:
            verdict = _message(str(error), corrupted, words)
        except TooSlow as error:
            verdict = Verdict("slow", str(error))
        except Exception as error:
            verdict = Verdict("foreign", f"{type(error).__name__}: {error}"[:300])
        else:
            checked = [] if keeps else answers
            verdict = _answer(answer, checked, given, corrupted, infinite or bool(keeps))
    loud = [w for w in told if not issubclass(w.category, DataWarning)]
    if verdict.kind in GOOD and loud:
        verdict = Verdict("warned", f"{loud[0].category.__name__}: {loud[0].message}")
    if any(not same(array, was) for array, was in before) or any(len(p) != n for p, n in plain):
        verdict = Verdict("mutated", "an input was changed")
    return verdict


def _message(words: str, corrupted: Mapping[str, bool], others: tuple[str, ...]) -> Verdict:
    if not words.strip() or "\n" in words or len(words) > 600:
        return Verdict("unreadable", words[:300])
    lower = words.lower().replace("_", " ")
    stems = [stem(name) for name in (*corrupted, *others)]
    if corrupted and not any(s in lower for s in stems):
        return Verdict("nameless", words)
    return Verdict("refused", words)


def stem(name: str) -> str:
    """The least of a name by which a message may call it: frame of ``frames``."""
    return name.lower().replace("_", " ").rstrip("s")


def _answer(answer, answers, given, corrupted, infinite) -> Verdict:
    if any(corrupted.values()):
        names = ", ".join(name for name, wrong in corrupted.items() if wrong)
        return Verdict("nonsense", f"{names} was accepted: {type(answer).__name__}")
    for array in answers:
        if array.dtype.kind in "fc" and not _finite(array, infinite):
            return Verdict("not finite", f"{type(answer).__name__} {array.ravel()[:6]}")
    for number in numbers_in([answer]):
        if not (np.isfinite(number) or infinite):
            return Verdict("not finite", f"{answer!r}"[:200])
    for array in answers:
        for mine in given:
            if array.size and mine.size and np.shares_memory(array, mine, max_work=10**5):
                return Verdict("aliased", f"{type(answer).__name__} shares memory with an input")
    return Verdict("fine", "")


def _finite(array: np.ndarray, infinite: bool) -> bool:
    return not np.isnan(array).any() if infinite else bool(np.isfinite(array).all())


@contextmanager
def time_limit() -> Iterator[None]:
    """Raise TooSlow where the body takes too much time."""

    def stop(number: int, frame: object) -> None:
        clock = "hangs" if number == signal.SIGALRM else f"takes more than {LIMIT} s"
        raise TooSlow(clock)

    kept = [(s, signal.signal(s, stop)) for s in (signal.SIGPROF, signal.SIGALRM)]
    signal.setitimer(signal.ITIMER_PROF, LIMIT)
    signal.setitimer(signal.ITIMER_REAL, HANG)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in kept:
            signal.signal(number, handler)


def same(array: np.ndarray, was: np.ndarray) -> bool:
    """Whether nothing changed, bit for bit."""
    if array.dtype.hasobject:
        return array.shape == was.shape and all(
            a is b for a, b in zip(array.ravel(), was.ravel(), strict=True)
        )
    return array.dtype == was.dtype and array.tobytes() == was.tobytes()


def parts_of(value: object) -> Iterator[object]:
    """What a value of tpsim or a container holds."""
    if isinstance(value, Mapping):
        yield from value.values()
    elif isinstance(value, tuple | list):
        yield from value
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from (getattr(value, field.name) for field in dataclasses.fields(value))
    elif hasattr(value, "data") and hasattr(value, "indices") and hasattr(value, "indptr"):
        yield value.data  # a sparse matrix


def walk(values: list[object]) -> Iterator[object]:
    """All values inside values."""
    waiting, seen = list(values), set()
    while waiting:
        value = waiting.pop()
        if isinstance(value, str | bytes | bool | int | float | np.generic | np.ndarray):
            yield value
        elif id(value) not in seen:
            seen.add(id(value))
            yield value
            waiting.extend(parts_of(value))


def arrays_in(values: list[object]) -> Iterator[np.ndarray]:
    """All arrays inside values."""
    return (np.asarray(v) if isinstance(v, np.matrix) else v for v in walk(values)
            if isinstance(v, np.ndarray))  # fmt: skip


def numbers_in(values: list[object]) -> Iterator[float]:
    """All floats inside values."""
    return (v for v in walk(values) if isinstance(v, float | np.floating))


def containers_in(values: list[object]) -> Iterator[object]:
    """All lists and dictionaries inside values."""
    return (v for v in walk(values) if isinstance(v, list | dict | set))


def raw_arrays(value: object) -> Iterator[np.ndarray]:
    """Arrays that the caller can still write to, not those that a value of tpsim owns."""
    if isinstance(value, np.ndarray):
        if not value.dtype.hasobject:
            yield value
    elif isinstance(value, list | tuple | Mapping) and not hasattr(value, "_fields"):
        for part in list(value.values()) if isinstance(value, Mapping) else value:
            if part is not value:
                yield from raw_arrays(part)
