"""Arrays at the border: floats without silent losses, and read-only copies."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpsim.errors import ArgumentError

Floats = NDArray[np.float64]


FLOAT = np.dtype(np.float64)


LARGEST = 1e100  # number whose powers and products stay finite


HUGE = 1e153  # number whose square stays finite


def finite_array(name: str, value: object) -> Floats:
    """Array of finite floats; the caller's own memory where it is one already.

    Raises
    ------
    ArgumentError
        Text, complex numbers, dates, masked or missing entries, ragged lists, NaN, infinity.
    """
    array = value if type(value) is np.ndarray and value.dtype is FLOAT else _floats(name, value)
    if array.size and not np.abs(array).max() < HUGE:
        if np.isfinite(array).all():
            raise ArgumentError(
                f"{name} reaches {np.abs(array).max():.1e}, beyond the support of numbers whose "
                f"squares stay finite; change units to stay below {HUGE:.0e}"
            )
        raise ArgumentError(
            f"{name} is not finite: NaN or infinite entries, the first "
            f"{place(~np.isfinite(array))}; remove or fill them first"
        )
    return array


def frozen_array(name: str, value: object) -> Floats:
    """Read-only copy, which nobody else can change, of an array of finite floats."""
    array = finite_array(name, value)
    array = array.copy() if array is value or array.base is not None else array
    array.setflags(write=False)
    return array


def frozen(array: np.ndarray) -> np.ndarray:
    """The same array, read-only: for results that nothing writes to any more."""
    array.setflags(write=False)
    return array


def own(value: object, *names: str) -> None:
    """Replace arrays of a frozen dataclass by read-only copies; None stays None."""
    for name in names:
        array = getattr(value, name)
        if array is not None:
            object.__setattr__(value, name, frozen(np.array(array)))


def shown(value: object) -> str:
    """What was given, in a few words on one line."""
    if getattr(type(value), "__module__", "").startswith("tpsim."):
        return f"a {type(value).__name__}"
    try:
        words = " ".join(repr(value).split())
    except Exception:  # whatever a foreign object raises, or an integer too long to print
        words = f"a {type(value).__name__}"
    return words if len(words) <= 80 else f"{words[:77]}..."


def place(wrong: np.ndarray) -> str:
    """Where the first true entry is: ``in row 3 of 100, column 1``."""
    if wrong.ndim == 0:
        return "and only one"
    row, *columns = (int(i) for i in np.argwhere(wrong)[0])
    column = f", column {columns[0] if len(columns) == 1 else tuple(columns)}" if columns else ""
    return f"in row {row} of {len(wrong)}{column}"


def array_of(name: str, value: object) -> NDArray[Any]:
    """Array of any type, or an ArgumentError where the value has no shape."""
    if isinstance(value, bytes | bytearray):
        raise ArgumentError(f"{name} holds bytes, no numbers; decode and convert them first")
    try:
        return np.asarray(value)
    except Exception as error:  # whatever the conversion of a foreign object raises
        words = " ".join(str(error).split())[:120]
        raise ArgumentError(f"{name} must be an array of numbers; {words}") from error


def _floats(name: str, value: object) -> Floats:
    """Conversion to floats that loses nothing in silence."""
    if type(value) is float:
        return np.array(value)
    parts: Sequence[object] = value if isinstance(value, list | tuple) else (value,)
    for part in parts:
        if isinstance(part, np.ma.MaskedArray) and np.ma.getmaskarray(part).any():
            where = place(np.ma.getmaskarray(part))
            raise ArgumentError(
                f"{name} has masked entries, the first {where}; fill or remove them first"
            )
    raw = array_of(name, value)
    if raw.dtype.kind in "fiub":
        return raw.astype(np.float64)
    kinds = {
        "c": "complex numbers; give real and imaginary parts as columns of their own",
        "S": "bytes, no numbers; decode and convert them first",
        "U": "text, no numbers; convert it first",
        "M": "dates, no numbers; give seconds",
        "m": "durations with a unit, no numbers; divide by np.timedelta64(1, 's')",
        "V": f"named fields {raw.dtype.names}, no plain numbers; stack the columns you mean",
    }
    if raw.dtype.kind in kinds:
        raise ArgumentError(f"{name} holds {kinds[raw.dtype.kind]}")
    return _of_objects(name, raw, value)


def _of_objects(name: str, raw: NDArray[Any], value: object) -> Floats:
    """Floats of Python objects, such as a table with columns of several types has them."""
    found = np.empty(raw.shape)
    for index in np.ndindex(raw.shape):
        entry = raw[index]
        try:
            if isinstance(entry, str | bytes | complex) or not hasattr(entry, "__float__"):
                raise TypeError(f"{shown(entry)} is no number")
            found[index] = float(entry)
        except (TypeError, ValueError, OverflowError) as error:
            names = getattr(value, "columns", None)
            column = f", column {names[index[1]]!r}" if names is not None and raw.ndim == 2 else ""
            row = f" in row {index[0]}{column}" if index else ""
            raise ArgumentError(f"{name} must be an array of numbers; {error}{row}") from error
    return found
