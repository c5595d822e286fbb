"""Values as JSON, and back: every type, key and number is checked on the way in."""

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import TypeVar, cast

import msgspec
import numpy as np

from tpsim.errors import RecordingError, one_line

T = TypeVar("T")


def plain(value: object) -> object:
    """Return JSON values of ``value``: dataclasses as objects, arrays and tuples as lists.

    Raises
    ------
    RecordingError
        If something in it is no number, text, list, mapping or dataclass, or is NaN.
    """
    try:
        return json.loads(json.dumps(value, default=_builtin), parse_constant=_constant)
    except (TypeError, ValueError, RecursionError) as error:
        raise RecordingError(f"{one_line(error)}: it cannot be written as JSON") from None


def to_json(value: object, indent: int | None = None) -> str:
    """Text of a value; equal values give equal texts.

    Infinity is written as Python writes it, so that values come back exactly.
    """
    return json.dumps(plain(value), indent=indent, sort_keys=indent is None)


def from_json(text: str, kind: type[T], where: object, defaults: bool = False) -> T:
    """Read a value that :func:`to_json` wrote.

    Parameters
    ----------
    text : str
    kind : type
        A dataclass, or a type that msgspec knows.
    where : object
        Name of the file, for messages.
    defaults : bool
        Whether what is missing has its default: in what people write, not in what was recorded.

    Raises
    ------
    RecordingError
        Names file and field: no JSON, a wrong type, a missing or unknown key, NaN.
    """
    try:
        found = json.loads(text, parse_constant=_constant, object_pairs_hook=_unique)
        # Half a surrogate pair is a text to Python alone.
        json.dumps(found, ensure_ascii=False).encode()
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"{where} is no JSON ({one_line(error)}); record it again") from None
    return restore(found, kind, where, defaults)


def restore(found: object, kind: type[T], where: object, defaults: bool = False) -> T:
    """Make a value of plain JSON values.

    Raises
    ------
    RecordingError
        Names file and field.
    """
    try:
        value = msgspec.convert(found, kind, dec_hook=_other)
        _compare_keys(found, plain(value), "$", defaults)
    except (msgspec.ValidationError, _KeysDiffer) as error:
        raise RecordingError(f"{where}: {one_line(error)}") from None
    except (TypeError, ValueError, RecursionError, ArithmeticError, LookupError) as error:
        raise RecordingError(f"{where} is no {kind.__name__}: {one_line(error)}") from None
    return value


class _KeysDiffer(Exception):
    """A key is missing or unknown."""


def _compare_keys(found: object, known: object, path: str, defaults: bool) -> None:
    """Defaults must not fill in for keys that are missing, and nothing is skipped."""
    if isinstance(found, Mapping) and isinstance(known, Mapping):
        for key in () if defaults else known.keys() - found.keys():
            raise _KeysDiffer(f"the field `{key}` is missing - at `{path}`")
        for key, item in found.items():
            if key not in known:
                raise _KeysDiffer(f"there is no field `{key}` - at `{path}`")
            _compare_keys(item, known[key], f"{path}.{key}", defaults)
    elif isinstance(found, list) and isinstance(known, list):
        for i, (item, other) in enumerate(zip(found, known, strict=False)):
            _compare_keys(item, other, f"{path}[{i}]", defaults)


def _builtin(value: object) -> object:
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, PurePath):
        return value.as_posix()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r:.60} is of type {type(value).__name__}")


def _other(kind: type, value: object) -> object:
    """What msgspec does not know itself: settings of any kind, and arrays."""
    if kind is object:
        return value
    if kind is np.ndarray:
        return np.array(cast(list[float], value), float)
    raise TypeError(f"{kind.__name__} cannot be read from JSON")


def _constant(name: str) -> float:
    if name == "NaN":
        raise ValueError("NaN is no number")
    return float(name)


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("a key occurs twice")
    return found
