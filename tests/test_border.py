"""The border by annotations: what is promised is brought about, or refused by name."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
import pytest
from numpy.typing import ArrayLike

from tpsim.border import Count, Endless, NotNegative, Point, Positive, border, checked, unchecked
from tpsim.errors import ArgumentError
from tpsim.frame import Frame


class Speaker(Protocol):
    def speak(self, loud: bool) -> str: ...


class Dog:
    def speak(self, loud):
        return "WUFF" if loud else "wuff"


@border
def call(
    number: Positive = 1.0,
    count: Count = 1,
    rng: np.random.Generator | int | None = None,
    frames: Sequence[Frame | None] = (),
    at: Literal["stops", "changes"] | ArrayLike = "stops",
    place: Point = (0.0, 0.0, 0.0),
    named: Mapping[str, float] | None = None,
    speaker: Speaker | None = None,
    path: str | Path = "a",
    then: Callable[[], object] | None = None,
):
    """Return what came through."""
    return locals()


FRAME = Frame(np.eye(2), np.zeros(2))


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ({"number": 2}, 2.0),
        ({"number": np.float32(0.5)}, 0.5),
        ({"count": np.uint8(3)}, 3),
        ({"frames": FRAME}, [FRAME]),
        ({"frames": (FRAME, None)}, [FRAME, None]),
        ({"at": "changes"}, "changes"),
        ({"place": np.arange(3)}, (0.0, 1.0, 2.0)),
        ({"named": {"a": 1}}, {"a": 1.0}),
        ({"path": "b.npz"}, Path("b.npz")),
    ],
)
def test_what_is_clear_is_brought_to_its_form(given, found):
    (name,) = given
    assert call(**given)[name] == found
    assert type(call(**given)[name]) is type(found)


def test_seeds_arrays_and_protocols():
    assert call(rng=3)["rng"].random() == np.random.default_rng(3).random()
    np.testing.assert_array_equal(call(at=[1, 2])["at"], [1.0, 2.0])
    dog = Dog()
    assert call(speaker=dog)["speaker"] is dog


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"number": 0}, "number is 0; give a finite, positive number"),
        ({"number": True}, "number is True"),
        ({"count": 1.5}, "count is 1.5; it must be a whole number"),
        ({"count": 10**12}, "count is too large"),
        ({"rng": -1}, "rng is -1"),
        ({"frames": [FRAME, 1]}, r"frames\[1\]"),
        ({"frames": {"a": FRAME}}, "frames is .*give a sequence"),
        ({"at": "ends"}, "at "),
        ({"place": (1, 2)}, "place is .*give 3"),
        ({"place": (1, 2, np.nan)}, r"place\[2\] is nan"),
        ({"named": {1: 1.0}}, "a key of named is 1; give text"),
        ({"speaker": Dog}, r"speaker is .*something with speak\(\)"),
        ({"path": "a\0b"}, "path is"),
        ({"then": 3}, "then is 3; give a function"),
    ],
)
def test_what_is_not_is_refused_by_name(given, words):
    with pytest.raises(ArgumentError, match=words):
        call(**given)


def test_what_python_says_itself_is_left_to_it():
    with pytest.raises(TypeError, match="unexpected keyword"):
        call(other=1)


@border
def several(
    first: Count, /, second: Positive = 1.0, *rest: Positive, last: Count = 1, **named: int
):
    """Return what came through."""
    return first, second, rest, last, named


def test_arguments_of_every_kind_find_their_readers():
    assert several(1, 2, 3, 4, last=np.uint8(5), more=6) == (1, 2.0, (3.0, 4.0), 5, {"more": 6})
    assert several(1, second=2) == (1, 2.0, (), 1, {})
    for given, named, words in (
        ((0,), {}, "first is 0"),
        ((1, 0), {}, "second is 0"),
        ((1, 2, 3, -4), {}, r"rest\[1\] is -4"),
        ((1,), {"second": -1}, "second is -1"),
        ((1,), {"last": 0.5}, "last is 0.5"),
    ):
        with pytest.raises(ArgumentError, match=words):
            several(*given, **named)
    # A name that stands for its place only, or for the rest, may be anybody's.
    assert several(1, first=2, rest=3)[-1] == {"first": 2, "rest": 3}
    for given, named, words in (
        ((), {}, "missing 1 required positional"),
        ((1, 2), {"second": 3}, "multiple values for argument 'second'"),
    ):
        with pytest.raises(TypeError, match=words):
            several(*given, **named)
    with pytest.raises(TypeError, match="positional arguments but 11"):
        call(1, 1, 3, (), "stops", (0, 0, 0), None, None, "a", None, 11)


@dataclass(frozen=True, eq=False)
class LongName:
    path: np.ndarray
    since: NotNegative = 0.0
    until: Endless = np.inf

    def __post_init__(self):
        checked(self)


def test_fields_own_their_arrays_and_say_whose_they_are():
    given = np.zeros(3)
    value = LongName(given, 1)
    given += 1
    assert not value.path.any()
    assert not value.path.flags.writeable
    assert isinstance(value.since, float)
    with pytest.raises(ArgumentError, match="long name since is -1"):
        LongName(given, -1)
    with pytest.raises(ArgumentError, match=r"long name path is not finite.*row 1"):
        LongName([0.0, np.nan])
    mine = np.ones(2)
    assert unchecked(LongName, path=mine).path is mine
