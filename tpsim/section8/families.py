"""Families of situations with a seeded teacher, whose own movement is the truth everywhere."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from tpsim.demonstration import Demonstration
from tpsim.examples import EXIT, u_demonstration, u_frames
from tpsim.frame import Frame
from tpsim.section8.method import Frames
from tpsim.timeline import rest_to_rest

BEND = 0.3  # how far a demonstration strays, where the task does not care [m]
MARKER = Frame(np.array([[0.0, -1.0], [1.0, 0.0]]), np.array([0.3, -0.2]))  # on the second object


@dataclass(frozen=True)
class Family:
    """A task whose situations are drawn nearer or farther than they were taught.

    Parameters
    ----------
    title : str
    draw : function of a Generator and a spread
        Frames of a situation; 1 is the spread of the demonstrations.
    teach : function of frames, a number of samples T, and a bend
        What the teacher does there; ``bend`` displaces it where the task does not care [m].
    seen : function of frames and the situation's number
        What the learner sees of them; None stands for a missing frame.
    """

    title: str
    draw: Callable[[np.random.Generator, float], tuple[Frame, ...]]
    teach: Callable[[tuple[Frame, ...], int, float], Demonstration]
    seen: Callable[[tuple[Frame, ...], int], Frames] = lambda frames, number: frames

    def demonstrations(self, count: int, samples: int, seed: int) -> list[Demonstration]:
        """Demonstrations of one teacher; the first ones are the same for every count."""
        rng = _stream(seed, 0)
        return [
            self.teach(self.draw(rng, 1.0), samples, rng.uniform(-BEND, BEND)) for _ in range(count)
        ]

    def situations(self, count: int, spread: float, samples: int, seed: int) -> list["Situation"]:
        """Situations for the learners of one teacher; for every spread along the same ways."""
        rng = _stream(seed, 1)
        drawn = []
        for number in range(count):
            frames = self.draw(rng, spread)
            drawn.append(
                Situation(
                    self.seen(frames, number),
                    self.teach(frames, samples, 0.0),
                    self.teach(frames, samples, rng.uniform(-BEND, BEND)),
                )
            )
        return drawn


@dataclass(frozen=True, eq=False)
class Situation:
    """A situation that was never taught.

    Parameters
    ----------
    frames : what the learner sees
    truth : Demonstration
        The teacher's movement there, without its free variation.
    drawn : Demonstration
        A demonstration as they are taught, with it: what a distribution should cover.
    """

    frames: Frames
    truth: Demonstration
    drawn: Demonstration


def _stream(seed: int, key: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(key,)))


def _transfer(frames: tuple[Frame, ...], samples: int, bend: float) -> Demonstration:
    """Teach the movement between the first two frames, however many there are."""
    taught = u_demonstration((frames[0], frames[1]), samples, bend=bend)
    return Demonstration(taught.time, taught.data, frames)


def _with_stranger(rng: np.random.Generator, spread: float) -> tuple[Frame, ...]:
    frames = u_frames(rng, spread)
    angle, place = spread * rng.uniform(-1.5, 1.5), spread * rng.uniform(-1.5, 1.5, 2)
    return (*frames, _frame(angle, place))


def _with_marker(rng: np.random.Generator, spread: float) -> tuple[Frame, ...]:
    first, second = u_frames(rng, spread)
    return first, second, Frame(second.A @ MARKER.A, second.to_common(MARKER.b))


def _hide_one_of_two(frames: tuple[Frame, ...], number: int) -> Frames:
    """Hide the second object or its marker, in turn."""
    hidden = 1 + number % 2
    return tuple(None if j == hidden else frame for j, frame in enumerate(frames))


def _with_via_point(rng: np.random.Generator, spread: float) -> tuple[Frame, ...]:
    first, second = u_frames(rng, spread)
    place = np.array([0.0, 1.0]) + spread * rng.uniform(-0.4, 0.4, 2)
    return first, _frame(spread * rng.uniform(-0.5, 0.5), place), second


def _through_via_point(frames: tuple[Frame, ...], samples: int, bend: float) -> Demonstration:
    """Leave the first object, pass the second along its first axis, enter the third."""
    start, via, goal = frames
    past = 0.3 * via.A[:, 0]
    leave, enter = start.b + EXIT * start.A[:, 1], goal.b + EXIT * goal.A[:, 1]
    free = bend * np.array([0.0, 0.5])
    points = [start.b, leave + free, via.b - past, via.b, via.b + past, enter + free, goal.b]
    knots = np.array([0.0, 0.2, 0.42, 0.5, 0.58, 0.8, 1.0])
    progress = np.linspace(0.0, 1.0, samples)
    smooth = rest_to_rest(progress)
    return Demonstration(2.0 * progress, CubicSpline(knots, np.array(points))(smooth), frames)


def _frame(angle: float, place: np.ndarray) -> Frame:
    c, s = np.cos(angle), np.sin(angle)
    return Frame(np.array([[c, -s], [s, c]]), place)


FAMILIES: dict[str, Family] = {
    "transfer": Family("out of one U and into another (Figs 1, 2, 12)", u_frames, _transfer),
    "via point": Family(
        "the same, past a third object on the way", _with_via_point, _through_via_point
    ),
    "irrelevant frame": Family(
        "the same, beside an object that does not matter", _with_stranger, _transfer
    ),
    "missing frame": Family(
        "the same, where the second object or a marker on it is hidden",
        _with_marker,
        _transfer,
        _hide_one_of_two,
    ),
}
"""Tasks that the comparison draws, by name."""
