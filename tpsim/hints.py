"""How values are read by a type hint: brought to the form that it asks for, or refused."""

import inspect
import types
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np
from numpy.typing import ArrayLike

from tpsim import checks
from tpsim.errors import ArgumentError

Reader = Callable[[str, object], object]
"""Takes an argument's name and what was given; returns it in the form asked for."""


def resolved(hint: object, known: dict[str, Any]) -> object:
    """The hint of a name; as it stands where it holds names that only type checkers know."""

    def holder() -> None: ...

    holder.__annotations__ = {"value": hint}
    try:
        return get_type_hints(holder, known, include_extras=True)["value"]
    except NameError:
        return object if isinstance(hint, str) else hint


def reader(hint: object) -> Reader:
    """How values of a hint are read."""
    origin, args = get_origin(hint), get_args(hint)
    if origin is ClassVar:
        return anything
    if origin is Annotated:
        own = [extra for extra in args[1:] if hasattr(extra, "read")]
        if own and args[0] is int:
            return cast(Reader, own[0].read_whole)
        return cast(Reader, own[0].read) if own else reader(args[0])
    if hint is ArrayLike or origin in (Union, types.UnionType):
        return _union(args)
    if origin is Literal:
        return partial(_choice, allowed=args)
    if origin is tuple:
        if args[-1] is Ellipsis:
            return _sequence_of(args[0], tuple)
        return partial(_fixed, items=[reader(arg) for arg in args])
    if origin is np.ndarray:
        return checks.finite_array
    if origin is type:
        return partial(_class, kind=args[0])
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return partial(_mapping, key=reader(args[0]), item=reader(args[1]))
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return _sequence_of(args[0], list)
    return _callable if Callable in (hint, origin) else _plain(hint)


def _plain(hint: object) -> Reader:
    """Reader of what has no parameters."""
    known: dict[object, Reader] = {
        float: checks.number,
        int: partial(checks.whole, least=-checks.MOST),
        bool: checks.flag,
        str: _text,
        np.ndarray: checks.finite_array,
        np.random.Generator: _generator,
        Path: _path,
        type(None): _nothing,
    }
    if hint in known:
        return known[hint]
    if not isinstance(hint, type) or hint in (object, Any):
        return anything
    if getattr(hint, "_is_protocol", False):
        return partial(_protocol, kind=hint)
    return partial(_instance, kind=hint)


_ARRAY = frozenset(get_args(ArrayLike))


def _union(args: tuple[object, ...]) -> Reader:
    """Reader of one of several."""
    arms = [arg for arg in args if arg not in _ARRAY or not set(args) >= _ARRAY]
    if np.random.Generator in arms:  # a seed is one as well
        return partial(_either, readers=[_generator], none=False)
    if str in arms and Path in arms:
        arms.remove(str)
    readers = [reader(arm) for arm in arms if arm is not type(None)]
    if set(args) >= _ARRAY:
        readers.append(checks.finite_array)
    if len(readers) == 1:
        return partial(_optional, read=readers[0]) if type(None) in args else readers[0]
    return partial(_either, readers=readers, none=type(None) in args)


def _optional(name: str, value: object, read: Reader) -> object:
    return None if value is None else read(name, value)


def _either(name: str, value: object, readers: list[Reader], none: bool) -> object:
    if value is None and none:
        return None
    refusals = []
    for read in readers:
        try:
            return read(name, value)
        except ArgumentError as error:
            refusals.append(str(error))
    # What speaks of a part of the value, or of allowed words where it is one, came nearest.
    near = [words for words in refusals if words.startswith(f"{name}[")]
    near += [words for words in refusals if isinstance(value, str) and "allowed: give" in words]
    said = near[0] if near else refusals[-1]
    others = [words.rpartition("; ")[2].removeprefix("or ") for words in refusals if words != said]
    also = "".join(f"; or {words}" for words in dict.fromkeys(others) if not near)
    raise ArgumentError(said + also)


def _sequence_of(hint: object, form: type) -> Reader:
    """Reader of any number of things of a hint; one alone counts as a sequence of one."""
    kinds = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
    own = [kind for kind in kinds if isinstance(kind, type) and kind not in _ARRAY]
    return partial(_sequence, item=reader(hint), own=own, form=form)


def _sequence(name: str, value: object, item: Reader, own: list[type], form: type) -> object:
    if type(value) not in (list, tuple):
        value = (
            [value]
            if any(_fits(value, kind) for kind in own)
            else checks.entries(name, value, tables=False)
        )
    return form([item(f"{name}[{i}]", one) for i, one in enumerate(cast(Iterable[object], value))])


def _fixed(name: str, value: object, items: list[Reader]) -> tuple[object, ...]:
    found = checks.entries(name, value, tables=False)
    if len(found) != len(items):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give {len(items)} in a row")
    return tuple(
        read(f"{name}[{i}]", one) for i, (read, one) in enumerate(zip(items, found, strict=True))
    )


def _mapping(name: str, value: object, key: Reader, item: Reader) -> Mapping[object, object]:
    if not isinstance(value, Mapping):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give a mapping, such as a dict")
    return {key(f"a key of {name}", k): item(f"{name}[{k!r}]", one) for k, one in value.items()}


def anything(name: str, value: object) -> object:
    """Whatever was given, as it is."""
    return value


def _text(name: str, value: object) -> str:
    if not isinstance(value, str):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give text")
    return value


def _choice(name: str, value: object, allowed: tuple[str, ...]) -> str:
    return checks.choice(name, value, allowed)


def _path(name: str, value: object) -> object:
    return checks.path(name, value)


def _generator(name: str, value: object) -> np.random.Generator:
    return checks.generator(name, cast(checks.Seed, value))


def _nothing(name: str, value: object) -> None:
    if value is not None:
        raise ArgumentError(f"{name} is {checks.shown(value)}; give None")


def _callable(name: str, value: object) -> object:
    if not callable(value):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give a function")
    return value


def _class(name: str, value: object, kind: type) -> object:
    if not isinstance(value, type) or not issubclass(value, kind):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give a class of {kind.__name__}")
    return value


def _instance(name: str, value: object, kind: type) -> object:
    return checks.instance(name, value, kind)


def _protocol(name: str, value: object, kind: type) -> object:
    if not _fits(value, kind):
        methods = " and ".join(f"{method}()" for method in _methods(kind))
        raise ArgumentError(f"{name} is {checks.shown(value)}; give something with {methods}")
    return value


def _fits(value: object, kind: type) -> bool:
    """Whether a value is of a class, or has the methods of a protocol."""
    if not getattr(kind, "_is_protocol", False):
        return isinstance(value, kind)
    try:
        has = [callable(getattr(value, method, None)) for method in _methods(kind)]
    except Exception:  # whatever a foreign object raises
        return False
    return not isinstance(value, type) and bool(has) and all(has)


def _methods(kind: type) -> list[str]:
    """Names of the methods that a protocol asks for."""
    return [
        key for key, member in vars(kind).items() if inspect.isfunction(member) and key[0] != "_"
    ]
