"""The border by annotations: what they promise, checked where something is called or made.

``@border`` checks the arguments of a function, ``checked(self)`` the fields of a frozen dataclass,
both by their annotations and by the checks of :mod:`tpsim.checks`. What is clear is brought to the
form that is asked for: an int to a float or a generator, one thing to a sequence of one, an array
to a tuple. All else is an ArgumentError that names the argument. Inner loops do not pass here.
"""

import inspect
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from functools import cache, wraps
from typing import (
    Annotated,
    Any,
    ParamSpec,
    TypeVar,
    cast,
)

import numpy as np

from tpsim import checks
from tpsim.errors import ArgumentError
from tpsim.hints import Reader, anything, reader, resolved

Given = ParamSpec("Given")
Answer = TypeVar("Answer")

_IN_PLACE = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
_NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
_REST = inspect.Parameter.VAR_POSITIONAL


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
        least = -checks.MOST if self.least is None else int(self.least)
        return checks.whole(
            name, value, least, most=checks.MOST if self.most is None else int(self.most)
        )


Positive = Annotated[float, Range(above=0)]
NotNegative = Annotated[float, Range(least=0)]
Share = Annotated[float, Range(least=0, below=1)]
Duration = Annotated[float, Range(above=0, most=1e6)]
"""[s], up to eleven days."""
Moment = Annotated[float, Range(least=0, most=1e6)]
"""[s] since the start."""
Strength = Annotated[float, Range(least=0, endless=True)]
Endless = Annotated[float, Range(endless=True)]
"""A number, or infinity."""
Count = Annotated[int, Range(least=1)]
Steps = Annotated[int, Range(least=1, most=1e6)]
Number = Annotated[int, Range(least=0)]
"""An index, or how many there are."""
SeedNumber = Annotated[int, Range(least=0, most=2**127)]
Point = tuple[float, float, float]
"""[m]"""


def border(function: Callable[Given, Answer]) -> Callable[Given, Answer]:
    """Check the arguments of a function by their annotations, and call it."""
    kinds = {name: one.kind for name, one in inspect.signature(function).parameters.items()}
    places = [name for name, kind in kinds.items() if kind in _IN_PLACE]
    named = {name for name, kind in kinds.items() if kind in _NAMED}
    rest = next((name for name, kind in kinds.items() if kind is _REST), "")
    count = len(places)

    @cache
    def readers() -> tuple[list[tuple[str, Reader]], dict[str, Reader]]:
        known = _readers_of(function)
        return (
            [(name, known.get(name, anything)) for name in places],
            {name: read for name, read in known.items() if name in named},
        )

    @wraps(function)
    def checked_call(*args: Given.args, **kwargs: Given.kwargs) -> Answer:
        in_place, by_name = readers()
        # What is missing, unknown or too many, Python says itself when the function is called.
        found = [read(name, value) for (name, read), value in zip(in_place, args, strict=False)]
        if len(args) > count:
            over = _readers_of(function).get(rest, anything)
            found += [over(f"{rest}[{i}]", value) for i, value in enumerate(args[count:])]
        for name in kwargs:
            if name in by_name:
                kwargs[name] = by_name[name](name, kwargs[name])
        return cast(Any, function)(*found, **kwargs)

    return checked_call


def checked(value: object) -> None:
    """Check the fields of a frozen dataclass, and bring them to the form that they promise.

    Arrays are copied, and read-only from then on.
    """
    kind: Any = type(value)
    for name, label, read_field in _fields_of(kind):
        given = getattr(value, name)
        try:
            found = _kept(read_field(label, given))
        except RecursionError:
            raise ArgumentError(f"{label} is {checks.shown(given)}; it holds itself") from None
        if found is not given:
            object.__setattr__(value, name, found)


def unchecked(kind: type[Answer], **values: object) -> Answer:
    """Make a frozen dataclass of results of our own, which are given away: no checks, no copies."""
    made = object.__new__(kind)
    for name, value in values.items():
        made.__dict__[name] = checks.frozen(value) if isinstance(value, np.ndarray) else value
    return made


@cache
def _fields_of(kind: Any) -> list[tuple[str, str, Reader]]:
    """Name, label for messages, and reader of every field of a dataclass."""
    owner = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind.__name__).lower()
    readers = _readers_of(kind)
    known = [field.name for field in fields(kind) if field.name in readers]
    return [(name, f"{owner} {name}", readers[name]) for name in known]


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
def _readers_of(owner: Any) -> dict[str, Reader]:
    kinds = reversed(owner.__mro__) if isinstance(owner, type) else (owner,)
    found = {}
    for kind in kinds:
        module = sys.modules.get(kind.__module__)
        # A class that came from another process may have left its module there.
        made = vars(kind).get("__init__")
        known = getattr(made, "__globals__", {}) if module is None else vars(module)
        for name, hint in inspect.get_annotations(kind).items():
            if name != "return":
                found[name] = reader(resolved(hint, known))
    return found


def read(name: str, value: object, hint: object) -> Any:
    """The value in the form that a hint asks for, or an ArgumentError."""
    return reader(hint)(name, value)
