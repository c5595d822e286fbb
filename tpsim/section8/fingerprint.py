"""Words that change when a function would answer something else: its code and what is bound."""

import functools
import hashlib
import inspect
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import FunctionType, MethodType

import numpy as np

import tpsim

MATHEMATICS = ("learning", "retrieval", "control")
"""Rooms of tpsim in which methods live, besides the values beneath them."""


def fingerprint(value: object) -> str:
    """SHA-256 of functions, by their source and what is bound to them, or of plain values.

    Of a function: its name, the text of the module that defines it (helpers and constants change
    what it does as well), defaults, and the values that it closes over; of ``functools.partial``,
    a bound method or an object that can be called, its arguments or attributes too. What shows
    itself by an address in memory is new in every process: too often new is never stale.

    Parameters
    ----------
    value
        A function or a value; mappings, sequences, arrays and objects are looked into.
    """
    return hashlib.sha256(json.dumps(_parts(value, frozenset())).encode()).hexdigest()


def mathematics(more: Sequence[str] = ()) -> str:
    """SHA-256 of the source of tpsim's mathematics, which all methods call, and of more rooms."""
    package = Path(tpsim.__file__).parent
    rooms = (package, *(package / room for room in (*MATHEMATICS, *more)))
    texts = [path.read_bytes() for room in rooms for path in sorted(room.glob("*.py"))]
    return hashlib.sha256(b"".join(texts)).hexdigest()


def _parts(value: object, above: frozenset[int]) -> object:
    """A value as nested lists of strings; ``above`` are the objects that hold it."""
    if id(value) in above:
        return "itself"
    above = above | {id(value)}
    if isinstance(value, FunctionType):
        cells = [_of_cell(cell) for cell in value.__closure__ or ()]
        bound = [value.__defaults__, value.__kwdefaults__, cells]
        return ["function", value.__qualname__, _source(value), _parts(bound, above)]
    if isinstance(value, functools.partial):
        return ["partial", _parts([value.func, value.args, value.keywords], above)]
    if isinstance(value, MethodType):
        return ["method", _parts([value.__func__, value.__self__], above)]
    if isinstance(value, type):
        return ["class", value.__qualname__, _source(value)]
    if isinstance(value, np.ndarray):
        content = repr(value.tolist()) if value.dtype.hasobject else value.tobytes().hex()
        return ["array", str(value.dtype), str(value.shape), content]
    if isinstance(value, Mapping):
        return ["mapping", [_parts([key, held], above) for key, held in value.items()]]
    if isinstance(value, list | tuple | set | frozenset):
        ordered = sorted(value, key=repr) if isinstance(value, set | frozenset) else value
        return [type(value).__name__, *(_parts(part, above) for part in ordered)]
    if hasattr(value, "__dict__"):
        return ["object", _parts([type(value), vars(value)], above)]
    return ["value", type(value).__qualname__, repr(value)]


def _of_cell(cell: object) -> object:
    """What a closure holds; nothing where it was not yet filled."""
    try:
        return cell.cell_contents  # type: ignore[attr-defined]
    except ValueError:
        return None


def _source(defined: FunctionType | type) -> str:
    """Hash of the text of the module that defines something; its own text in a notebook."""
    for found in (inspect.getmodule(defined), defined):
        try:
            return _text(found)
        except (OSError, TypeError):
            continue
    return "no source"


@functools.cache
def _text(defined: object) -> str:
    return hashlib.sha256(inspect.getsource(defined).encode()).hexdigest()  # type: ignore[arg-type]
