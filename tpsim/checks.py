"""Checks at the border: what every public function asks of its arguments, written once.

Each function takes the name under which the user knows the argument, and returns the argument in
the one form that the code behind the border works with, or raises an ArgumentError that says what
was given, what is allowed and, in an array, where the first offence is.
"""

from collections.abc import Collection, Iterable, Mapping, Set
from os import PathLike, fspath
from pathlib import Path
from typing import TypeVar, cast

import numpy as np

from tpsim.arrays import FLOAT as FLOAT
from tpsim.arrays import HUGE as HUGE
from tpsim.arrays import LARGEST as LARGEST
from tpsim.arrays import Floats as Floats
from tpsim.arrays import array_of as array_of
from tpsim.arrays import finite_array as finite_array
from tpsim.arrays import frozen as frozen
from tpsim.arrays import frozen_array as frozen_array
from tpsim.arrays import own as own
from tpsim.arrays import place as place
from tpsim.arrays import shown as shown
from tpsim.errors import ArgumentError, ItemError

Value = TypeVar("Value")
Seed = int | np.random.Generator | None

MOST = 10**9  # as many of anything nobody means
LARGEST_SEED = 2**128
NO_LISTS = str | bytes | bytearray | Mapping | Set  # text, and what has no order
ROOM = 2**27  # numbers in an array: one gibibyte
LONGEST_NAME = 1000  # letters in the path of a file
SMALLEST = 1e-150  # number whose square is still there
FASTEST = 1e-100  # [s]: rates of change over shorter steps leave the range of floating point


def matrix(name: str, value: object, columns: int | None = None) -> Floats:
    """Rows (N, D), N and D >= 1; a single row (D,) where the number of columns is known."""
    array = finite_array(name, value)
    if array.ndim == 1 and columns is not None and len(array) == columns:
        array = array[None]
    if array.ndim != 2 or 0 in array.shape or columns not in (None, array.shape[1]):
        wanted = "D" if columns is None else columns
        raise ArgumentError(
            f"{name} has shape {array.shape}; give (N, {wanted}), one row per sample, N >= 1"
        )
    return array


def column_or_matrix(name: str, value: object) -> Floats:
    """Rows (N, D), N >= 1; a flat array (N,) is one column."""
    array = finite_array(name, value)
    return matrix(name, array[:, None] if array.ndim == 1 else array)


def stamps(name: str, value: object) -> Floats:
    """Strictly increasing times (T,) in seconds, T >= 1.

    Numbers are seconds. Durations (timedelta) are converted by their own unit, dates (datetime)
    to seconds since the first of them.
    """
    time = finite_array(name, seconds(name, value))
    if time.ndim != 1 or len(time) == 0:
        raise ArgumentError(f"{name} has shape {time.shape}; give (T,), T >= 1")
    steps = np.diff(time)
    if (steps <= 0).any():
        i = int(np.argmax(steps <= 0)) + 1
        coarse = getattr(value, "dtype", None) == np.float32
        raise ArgumentError(
            f"{name} must increase strictly, but sample {i} ({time[i]:.9g} s) does not come after "
            f"sample {i - 1} ({time[i - 1]:.9g} s)"
            + ("; float32 cannot tell them apart: keep time in float64" if coarse else "")
        )
    if len(steps) and steps.min() < FASTEST:
        raise ArgumentError(
            f"{name} has steps of {steps.min():.1e} s; change the unit to stay above {FASTEST:.0e}"
        )
    return time


def seconds(name: str, value: object) -> object:
    """Dates and durations as numbers [s], dates since the first of them; all else as it is."""
    raw = array_of(name, value)
    if raw.size == 0 or isinstance(value, np.ma.MaskedArray):
        return value
    first = raw.flat[0]
    if raw.dtype == object and hasattr(first, "total_seconds"):
        return np.vectorize(lambda one: one.total_seconds(), otypes=[float])(raw)
    if raw.dtype == object and hasattr(first, "utcoffset"):
        return np.vectorize(lambda one: (one - first).total_seconds(), otypes=[float])(raw)
    if raw.dtype.kind not in "mM":
        return value
    if np.isnat(raw).any():
        raise ArgumentError(f"{name} holds NaT, the first {place(np.isnat(raw))}; remove it first")
    if np.datetime_data(raw.dtype)[0] == "generic":
        raise ArgumentError(f"{name} holds durations without a unit; give seconds as numbers")
    durations = raw - first if raw.dtype.kind == "M" else raw
    try:
        return durations / np.timedelta64(1, "s")
    except TypeError as error:
        raise ArgumentError(f"{name} holds {raw.dtype}, which is no number of seconds") from error


def number(
    name: str,
    value: object,
    *,
    least: float | None = None,
    above: float | None = None,
    below: float | None = None,
    what: str = "number",
) -> float:
    """Finite number, where asked for at least, above, or below a limit; ``what`` says of what."""
    scalar = value
    hidden = isinstance(value, np.ma.MaskedArray) and bool(np.ma.getmaskarray(value).any())
    if isinstance(value, np.ndarray | np.generic) and value.size == 1 and not hidden:
        scalar = value.item()
    if isinstance(scalar, int | float) and not isinstance(scalar, bool) and abs(scalar) < LARGEST:
        high_enough = (least is None or scalar >= least) and (above is None or scalar > above)
        lost = above == 0 and scalar < SMALLEST
        if high_enough and not lost and (below is None or scalar < below):
            return float(scalar)
    limits = [
        f"above {above:g}" if above else "",
        "not negative" if least == 0 else f"at least {least:g}" if least is not None else "",
        f"below {below:g}" if below is not None else "",
    ]
    words = "".join(f", {words}" for words in limits if words)
    kind = "finite, positive" if above == 0 else "finite"
    raise ArgumentError(f"{name} is {shown(value)}; give a {kind} {what}{words}")


def felt(name: str, value: object) -> Floats:
    """Finite floats of which the largest does not vanish when it is squared, or all are zero."""
    if type(value) is float and SMALLEST <= abs(value) < HUGE:
        return np.array(value)
    plain = type(value) is np.ndarray and value.dtype is FLOAT
    array = cast(Floats, value) if plain else finite_array(name, value)
    largest = np.abs(array).max() if array.size else 0.0
    if SMALLEST <= largest < HUGE or largest == 0:
        return array
    finite_array(name, array)
    raise ArgumentError(
        f"{name} reaches {largest:.1e} at most; change units to come above {SMALLEST:.0e}"
    )


def bound(name: str, value: object) -> float:
    """Number that may be infinite, but not NaN: where an iteration ends."""
    try:
        right = isinstance(value, int | float | np.number) and not isinstance(value, np.timedelta64)
        found = float(cast(float, value)) if right else np.nan
    except OverflowError:
        found = np.nan
    if np.isnan(found):
        raise ArgumentError(f"{name} is {shown(value)}; it must be a number")
    return found


def flag(name: str, value: object) -> bool:
    """True or False."""
    if not isinstance(value, bool | np.bool_):
        raise ArgumentError(f"{name} is {shown(value)}; give True or False")
    return bool(value)


def whole(name: str, value: object, least: int = 0, hint: str = "", most: int = MOST) -> int:
    """Whole number from ``least`` upwards, to ``most``."""
    if isinstance(value, int | np.integer) and not isinstance(value, bool | np.timedelta64):
        if value > most:
            raise ArgumentError(f"{name} is too large; allowed are whole numbers up to {most}")
        if value >= least:
            return int(value)
    raise ArgumentError(
        f"{name} is {shown(value)}; it must be a whole number, at least {least} ({least} or more)"
        + (f"; {hint}" if hint else "")
    )


def affordable(name: str, count: object, each: int = 1, least: int = 1) -> int:
    """Whole number of things of which each takes ``each`` numbers, within a gibibyte together."""
    found = whole(name, count, least)
    if found * max(each, 1) > ROOM:
        raise ArgumentError(
            f"{name} is {found}: that takes {8 * found * each / 2**30:.1f} GiB; give at most "
            f"{ROOM // max(each, 1)}"
        )
    return found


def picked(array: np.ndarray, index: object) -> np.ndarray:
    """Part of an array; an ItemError where the index means nothing."""
    try:
        found: np.ndarray = array[cast(int, index)]
    except Exception as error:  # whatever numpy, or a foreign object, raises
        raise ItemError(f"index is {shown(index)}; {' '.join(str(error).split())[:200]}") from None
    return found


def path(name: str, value: object) -> Path:
    """Name of a file or a folder."""
    if isinstance(value, str | PathLike):
        text = fspath(value)
        if isinstance(text, str) and text.isprintable() and 0 < len(text) < LONGEST_NAME:
            return Path(text)
    raise ArgumentError(f"{name} is {shown(value)}; give the name of a file or a folder")


def choice(name: str, value: object, allowed: Collection[str]) -> str:
    """One of the allowed words."""
    if not isinstance(value, str) or value not in allowed:
        words = " or ".join(repr(word) for word in allowed)
        raise ArgumentError(f"{name} is {shown(value)}; allowed: give {words}")
    return value


def instance(name: str, value: object, kind: type[Value], hint: str = "") -> Value:
    """A value of the class that is asked for."""
    if not isinstance(value, kind):
        tail = f"; {hint}" if hint else ""
        raise ArgumentError(
            f"{name} is a {type(value).__name__}, where a {kind.__name__} belongs{tail}"
        )
    return value


def several(name: str, value: object, kind: type[Value], hint: str = "") -> list[Value]:
    """List of values of a class; one alone counts as a list of one."""
    if isinstance(value, kind):
        return [value]
    wanted = f"one or more {kind.__name__}" + (f"; {hint}" if hint else "")
    items = _items(name, value, wanted)
    return [instance(f"{name}[{i}]", one, kind, hint) for i, one in enumerate(items)]


def entries(name: str, value: object, *, tables: bool = True) -> list[object]:
    """List of whatever a sequence holds; a table, an array (N, D), counts as a list of one.

    Without ``tables`` it counts as its rows.
    """
    if tables and is_table(name, value):
        return [value]
    return _items(name, value, "a sequence")


def _items(name: str, value: object, wanted: str) -> list[object]:
    """Items of what has an order; text, a mapping and a set are no sequences."""
    if isinstance(value, Iterable) and not isinstance(value, NO_LISTS):
        try:
            return list(value)
        except Exception:  # whatever a foreign object, or an array without axes, raises
            pass
    raise ArgumentError(f"{name} is {shown(value)}; give {wanted}")


def is_table(name: str, value: object) -> bool:
    """Whether this is one array of samples: an array (N, D), or a table with rows and columns."""
    array = not isinstance(value, list | tuple) and hasattr(value, "__array__")
    return array and np.ndim(array_of(name, value)) == 2


def dimensions(name: str, value: object, size: int) -> np.ndarray:
    """Different indices out of 0 ... size - 1, counted from the end where negative."""
    dims = np.atleast_1d(array_of(name, value))
    if dims.dtype.kind not in "iu" or dims.ndim != 1:
        raise ArgumentError(f"{name} is {shown(value)}; it must be at least one integer")
    if dims.size == 0 or dims.min() < -size or dims.max() >= size:
        raise ArgumentError(
            f"{name} is {dims.tolist()}; give different dimensions out of 0 to {size - 1}, at "
            "least one"
        )
    dims = dims % size
    if len(np.unique(dims)) < len(dims):
        raise ArgumentError(f"{name} is {dims.tolist()}; give different dimensions")
    return dims


def generator(name: str, rng: Seed, default: int | None = None) -> np.random.Generator:
    """Random numbers from a Generator, or from a seed; from ``default`` where None is given."""
    if isinstance(rng, np.random.Generator):
        return rng
    seed = default if rng is None else rng
    right = isinstance(seed, int | np.integer) and not isinstance(seed, bool | np.timedelta64)
    number_of_it = int(cast(int, seed)) if right else -1
    if not 0 <= number_of_it < LARGEST_SEED:
        raise ArgumentError(
            f"{name} is {shown(rng)}; give a numpy Generator or a seed, an int from 0 below 2^128"
        )
    return np.random.default_rng(number_of_it)
