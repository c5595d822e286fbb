"""What people do in a campaign: ranges and levels of pushes and leads."""

from dataclasses import dataclass, fields
from typing import Literal

from tpsim.border import NotNegative, Point, Positive, Strength, checked
from tpsim.errors import ArgumentError

AXES: tuple[Point, ...] = (
    (1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, 0.0, 1.0),
    (-1.0, 0.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, -1.0),
)
"""The six directions along the world's axes."""


@dataclass(frozen=True)
class Span:
    """A range from which numbers are drawn, or which a Latin hypercube divides.

    Parameters
    ----------
    low, high : float
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        checked(self)
        if not self.low < self.high:
            raise ArgumentError(f"a span goes from {self.low:g} to {self.high:g}; give low < high")


Levels = tuple[float, ...] | Span
"""Values of a condition: each of several, or drawn from a span."""

Directions = tuple[Point, ...] | Literal["circle", "sphere"]
"""Directions in the world: each of several, or drawn from a horizontal circle or a sphere."""


@dataclass(frozen=True)
class Pushes:
    """Pushes that a campaign tries; what has levels is combined, what has a span is drawn.

    Parameters
    ----------
    body : tuple of str
        Bodies or sites; the task's first hand by default.
    direction : tuple of (3,), "circle" or "sphere"
        Of the force in the world; lengths do not count.
    force : levels, optional
        [N]; 20 N by default, where no impulse is given.
    impulse : levels, optional
        Force times duration [Ns], instead of a force.
    onset : levels, optional
        When a push begins [s].
    phase : levels, optional
        When it begins, as a share of the time in which it can begin and end, instead of an onset:
        from 0 to 1, which is the default.
    duration : levels
        How long it lasts [s].
    """

    body: tuple[str, ...] = ()
    direction: Directions = AXES
    force: Levels | None = None
    impulse: Levels | None = None
    onset: Levels | None = None
    phase: Levels | None = None
    duration: Levels = (2.0,)

    def __post_init__(self) -> None:
        checked(self)
        _one_of(self, "force", "impulse")
        _one_of(self, "onset", "phase")
        for name, most in (("force", None), ("impulse", None), ("onset", None), ("phase", 1.0)):
            _within(self, name, most)
        _within(self, "duration", None, positive=True)
        _check_directions(self)


@dataclass(frozen=True)
class Leads:
    """Leads that a campaign tries: a person takes a hand off the way that it goes by itself.

    Parameters
    ----------
    body : tuple of str
        Sites that the task records; its first hand by default.
    direction : tuple of (3,), "circle" or "sphere"
        Of the way in the world.
    travel : levels
        How far the site is led [m].
    onset : levels, optional
        When it begins [s].
    phase : levels, optional
        As for :class:`Pushes`.
    duration : levels
        How long it takes [s]; the person then stays there for ``rest``.
    rest : float
        [s]
    stiffness : float
        Of the grip [N/m].
    max_force : float
        Strength of the person [N].
    """

    body: tuple[str, ...] = ()
    direction: Directions = "circle"
    travel: Levels = (0.15,)
    onset: Levels | None = None
    phase: Levels | None = None
    duration: Levels = (1.5,)
    rest: NotNegative = 0.5
    stiffness: Positive = 2000.0
    max_force: Strength = 60.0

    def __post_init__(self) -> None:
        checked(self)
        _one_of(self, "onset", "phase")
        for name, most in (("onset", None), ("phase", 1.0)):
            _within(self, name, most)
        for name in ("travel", "duration"):
            _within(self, name, None, positive=True)
        _check_directions(self)


def _one_of(given: object, one: str, other: str) -> None:
    if getattr(given, one) is not None and getattr(given, other) is not None:
        raise ArgumentError(f"{_kind(given)} have both {one} and {other}; give one of them")


def _within(given: object, name: str, most: float | None, positive: bool = False) -> None:
    levels = getattr(given, name)
    if levels is None:
        return
    values = (levels.low, levels.high) if isinstance(levels, Span) else levels
    if not values:
        raise ArgumentError(f"{_kind(given)} {name} is empty; give at least one value")
    least = min(values)
    if least < 0 or (positive and least <= 0) or (most is not None and max(values) > most):
        allowed = "above 0" if positive else "from 0 on" if most is None else f"from 0 to {most:g}"
        raise ArgumentError(f"{_kind(given)} {name} is {levels}; give values {allowed}")


def _check_directions(given: Pushes | Leads) -> None:
    if isinstance(given.direction, str):
        return
    if not given.direction or not all(map(any, given.direction)):
        raise ArgumentError(
            f"{_kind(given)} direction is {given.direction}; give vectors that are not zero, "
            "'circle' or 'sphere'"
        )


def _kind(given: object) -> str:
    return type(given).__name__.lower()


def levels_of(people: Pushes | Leads) -> dict[str, tuple | Span]:
    """What varies, by name: tuples are combined, spans drawn; a circle is a span of angles."""
    found: dict[str, tuple | Span] = {}
    for field in fields(people):
        value = getattr(people, field.name)
        if field.name == "direction" and isinstance(value, str):
            found["turn"] = Span(0.0, 1.0)
            if value == "sphere":
                found["height"] = Span(-1.0, 1.0)
        elif isinstance(value, tuple | Span) and value != ():
            found[field.name] = value
    if "onset" not in found:
        found.setdefault("phase", Span(0.0, 1.0))
    if isinstance(people, Pushes) and "impulse" not in found:
        found.setdefault("force", (20.0,))
    return found
