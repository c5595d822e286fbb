"""The border by annotations: what they promise, checked where something is called or made.

``@border`` checks the arguments of a function, ``checked(self)`` the fields of a frozen dataclass,
both by their annotations and by the checks of :mod:`tpsim.checks`. What is clear is brought to the
form that is asked for: an int to a float or a generator, one thing to a sequence of one, an array
to a tuple. All else is an ArgumentError that names the argument. Inner loops do not pass here.
"""

import inspect
import re
import sys
import types
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cache, partial, wraps
from pathlib import Path
from typing import (
    Annotated,
    Any,
    ClassVar,
    Literal,
    ParamSpec,
    TypeVar,
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

Given = ParamSpec("Given")
Answer = TypeVar("Answer")
Reader = Callable[[str, object], object]
"""Takes an argument's name and what was given; returns it in the form asked for."""


@dataclass(frozen=True)
class Range:
    """Where a number lies: at least, above, below or at most a limit; perhaps without an end."""

    least: float | None = None
    above: float | None = None
    below: float | None = None
    most: float | None = None
    endless: bool = False

    def read(self, name: str, value: object) -> float:
        """The number, checked."""
        if self.endless and isinstance(value, float) and value == np.inf:
            return value
        found = checks.number(name, value, least=self.least, above=self.above, below=self.below)
        if self.most is not None and found > self.most:
            raise ArgumentError(f"{name} is {found:g}; give at most {self.most:g}")
        return found

    def read_whole(self, name: str, value: object) -> int:
        """The whole number, checked."""
        found = checks.whole(name, value, -checks.MOST if self.least is None else int(self.least))
        if self.most is not None and found > self.most:
            raise ArgumentError(f"{name} is {found}; give at most {self.most:g}")
        return found


Positive = Annotated[float, Range(above=0)]
NotNegative = Annotated[float, Range(least=0)]
Share = Annotated[float, Range(least=0, below=1)]
Duration = Annotated[float, Range(above=0, most=1e6)]
"""[s], up to eleven days."""
Moment = Annotated[float, Range(least=0, most=1e6)]
"""[s] since the start."""
Endless = Annotated[float, Range(endless=True)]
"""A number, or infinity."""
Count = Annotated[int, Range(least=1)]
Steps = Annotated[int, Range(least=1, most=1e6)]
Number = Annotated[int, Range(least=0)]
"""A seed, an index, or how many there are."""
Point = tuple[float, float, float]
"""[m]"""


def border(function: Callable[Given, Answer]) -> Callable[Given, Answer]:
    """Check the arguments of a function by their annotations, and call it."""
    signature = inspect.signature(function)
    kinds = {name: parameter.kind for name, parameter in signature.parameters.items()}

    @wraps(function)
    def checked_call(*args: Given.args, **kwargs: Given.kwargs) -> Answer:
        try:
            bound = signature.bind(*args, **kwargs)
        except TypeError:
            return function(*args, **kwargs)  # which says itself what is missing
        readers, given = _readers_of(function), bound.arguments
        for name in given.keys() & readers.keys():
            read, value = readers[name], given[name]
            if kinds[name] is inspect.Parameter.VAR_POSITIONAL:
                given[name] = tuple(read(f"{name}[{i}]", one) for i, one in enumerate(value))
            elif kinds[name] is not inspect.Parameter.VAR_KEYWORD:
                given[name] = read(name, value)
        return function(*bound.args, **bound.kwargs)

    return checked_call


def checked(value: object) -> None:
    """Check the fields of a frozen dataclass, and bring them to the form that they promise.

    Arrays are copied, and read-only from then on.
    """
    kind = type(value)
    readers, owner = _readers_of(kind), re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind.__name__).lower()
    for field in fields(value):  # type: ignore[arg-type]
        if field.name in readers:
            given = getattr(value, field.name)
            found = _kept(readers[field.name](f"{owner} {field.name}", given))
            if found is not given:
                object.__setattr__(value, field.name, found)


def _kept(value: object) -> object:
    """The value, with arrays that nobody else can change, and tuples instead of lists."""
    if isinstance(value, np.ndarray):
        return checks.frozen(value.copy())
    if type(value) in (list, tuple):
        return tuple(_kept(part) for part in cast(Iterable[object], value))
    if type(value) is dict:
        return {key: _kept(part) for key, part in value.items()}
    return value


@cache
def _readers_of(owner: Callable[..., object]) -> dict[str, Reader]:
    kinds = reversed(owner.__mro__) if isinstance(owner, type) else (owner,)
    found = {}
    for kind in kinds:
        known = vars(sys.modules[kind.__module__])
        for name, hint in inspect.get_annotations(kind).items():
            if name != "return":
                found[name] = _reader(_resolved(hint, known))
    return found


def _resolved(hint: object, known: dict[str, Any]) -> object:
    """The hint of a name; as it stands where it holds names that only type checkers know."""

    def holder() -> None: ...

    holder.__annotations__ = {"value": hint}
    try:
        return get_type_hints(holder, known, include_extras=True)["value"]
    except NameError:
        return object if isinstance(hint, str) else hint


def read(name: str, value: object, hint: object) -> Any:
    """The value in the form that a hint asks for, or an ArgumentError."""
    return _reader(hint)(name, value)


def _reader(hint: object) -> Reader:
    """How values of a hint are read."""
    origin, args = get_origin(hint), get_args(hint)
    if origin is ClassVar:
        return _anything
    if origin is Annotated:
        own = [extra for extra in args[1:] if hasattr(extra, "read")]
        if own and args[0] is int:
            return cast(Reader, own[0].read_whole)
        return cast(Reader, own[0].read) if own else _reader(args[0])
    if hint is ArrayLike or origin in (Union, types.UnionType):
        return _union(args)
    if origin is Literal:
        return partial(_choice, allowed=args)
    if origin is tuple:
        if args[-1] is Ellipsis:
            return partial(_sequence, item=_reader(args[0]), alone=args[0], form=tuple)
        return partial(_fixed, items=[_reader(arg) for arg in args])
    if origin is np.ndarray:
        return checks.finite_array
    if origin is type:
        return partial(_class, kind=args[0])
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return partial(_mapping, key=_reader(args[0]), item=_reader(args[1]))
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return partial(_sequence, item=_reader(args[0]), alone=args[0], form=list)
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
        return _anything
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
    readers = [_reader(arm) for arm in arms if arm is not type(None)]
    if set(args) >= _ARRAY:
        readers.append(checks.finite_array)
    return partial(_either, readers=readers, none=type(None) in args)


def _either(name: str, value: object, readers: list[Reader], none: bool) -> object:
    if value is None and none:
        return None
    *others, last = readers
    complaints = []
    for reader in others:
        try:
            return reader(name, value)
        except ArgumentError as error:
            complaints.append(str(error).rpartition("; ")[2])
    try:
        return last(name, value)
    except ArgumentError as error:
        if not complaints:
            raise
        also = ", or ".join(dict.fromkeys(complaints))
        raise ArgumentError(f"{error}; or {also}") from None


def _sequence(name: str, value: object, item: Reader, alone: object, form: type) -> object:
    if isinstance(alone, type) and _fits(value, alone):
        value = [value]
    return form(
        item(f"{name}[{i}]", one) for i, one in enumerate(checks.entries(name, value, tables=False))
    )


def _fixed(name: str, value: object, items: list[Reader]) -> tuple[object, ...]:
    found = checks.entries(name, value, tables=False)
    if len(found) != len(items):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give {len(items)} of them")
    return tuple(
        read(f"{name}[{i}]", one) for i, (read, one) in enumerate(zip(items, found, strict=True))
    )


def _mapping(name: str, value: object, key: Reader, item: Reader) -> Mapping[object, object]:
    if not isinstance(value, Mapping):
        raise ArgumentError(f"{name} is {checks.shown(value)}; give a mapping, such as a dict")
    return {key(f"a key of {name}", k): item(f"{name}[{k!r}]", one) for k, one in value.items()}


def _anything(name: str, value: object) -> object:
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
    return not isinstance(value, type) and all(has)


def _methods(kind: type) -> list[str]:
    """Names of the methods that a protocol asks for."""
    return [
        key for key, member in vars(kind).items() if inspect.isfunction(member) and key[0] != "_"
    ]
