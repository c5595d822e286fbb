"""Synthetic movements like those of the tutorial's figures, made anew wherever they are needed."""

from itertools import pairwise

import numpy as np

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.timeline import rest_to_rest

LETTERS = {
    "G": [(0.7, 0.8), (0, 1), (-0.8, 0), (0, -1), (0.8, -0.6), (0.8, 0), (0.2, 0)],
    "S": [(0.6, 0.8), (0, 1), (-0.6, 0.6), (0, 0), (0.6, -0.6), (0, -1), (-0.6, -0.8)],
    "C": [(0.7, 0.8), (0, 1), (-0.8, 0), (0, -1), (0.7, -0.8)],
}
"""Points that a pen passes through."""

EXIT = 0.6  # how far the walls of a U reach, beside its own origin


def u_frames(rng: np.random.Generator, spread: float = 1.0) -> tuple[Frame, Frame]:
    """Draw a situation of Figs 1, 2 and 12: two U-shaped objects in the plane.

    The movement leaves the first object and enters the second along the open side of its U, the
    second axis of its frame.

    Parameters
    ----------
    rng : numpy Generator
        Draws positions and angles.
    spread : float
        1 for the range of the demonstrations, more for situations farther away.
    """
    angles = np.array([-0.4, 0.3]) + spread * rng.uniform(-0.5, 0.5, 2)
    origins = np.array([[-1.2, -0.5], [1.2, 0.4]]) + spread * rng.uniform(-0.3, 0.3, (2, 2))
    first, second = (Frame(_rotation(a), b) for a, b in zip(angles, origins, strict=True))
    return first, second


def u_demonstration(
    frames: tuple[Frame, Frame], samples: int = 200, duration: float = 2.0, bend: float = 0.0
) -> Demonstration:
    """Movement out of the first U and into the second, at rest at both ends.

    Parameters
    ----------
    frames : two Frames
        Where the objects are.
    samples : int
        Number of samples T.
    duration : float
        Seconds.
    bend : float
        How far the middle of the path, where the task does not care, is displaced.
    """
    if samples < 2:
        raise ArgumentError(f"samples is {samples}; a movement needs at least 2")
    start, end = (frame.b for frame in frames)
    leave, enter = (frame.b + EXIT * frame.A[:, 1] for frame in frames)
    middle = 0.5 * (leave + enter) + np.array([0.0, 0.4 + bend])
    time = np.linspace(0.0, duration, samples)
    phase = rest_to_rest(time / duration)
    data = _bezier([start, leave, middle, enter, end], phase)
    return Demonstration(time, data, frames)


def u_demonstrations(
    count: int = 4, samples: int = 200, rng: np.random.Generator | None = None
) -> list[Demonstration]:
    """Draw demonstrations of the task of Figs 1, 2 and 12 in ``count`` situations.

    The same ``rng`` gives the same movements; the default always gives the same.
    """
    rng = np.random.default_rng(2016) if rng is None else rng
    return [
        u_demonstration(u_frames(rng), samples, bend=rng.uniform(-0.3, 0.3)) for _ in range(count)
    ]


def letters(
    name: str = "G", count: int = 4, samples: int = 200, rng: np.random.Generator | None = None
) -> list[Demonstration]:
    """Draw a letter ``count`` times, a little differently every time, without frames.

    Parameters
    ----------
    name : str
        ``"G"``, ``"S"`` or ``"C"``.
    count : int
        Number of demonstrations.
    samples : int
        Number of samples T of each.
    rng : numpy Generator, optional
        Moves the points that the pen passes through; by default always in the same way.
    """
    from scipy.interpolate import CubicSpline

    if name not in LETTERS:
        raise ArgumentError(f"letter {name!r} is not known; there are {', '.join(LETTERS)}")
    rng = np.random.default_rng(2016) if rng is None else rng
    points = np.array(LETTERS[name])
    time = np.linspace(0.0, 2.0, samples)
    phase = rest_to_rest(time / 2.0)
    passed = np.linspace(0.0, 1.0, len(points))
    return [
        Demonstration(time, CubicSpline(passed, moved)(phase), name=name)
        for moved in points + 0.05 * rng.standard_normal((count, *points.shape))
    ]


def _rotation(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _bezier(points: list[np.ndarray], phase: np.ndarray) -> np.ndarray:
    """Bezier curve by repeated interpolation between its control points."""
    curves = [np.broadcast_to(point, (len(phase), len(point))) for point in points]
    s = phase[:, None]
    while len(curves) > 1:
        curves = [(1 - s) * a + s * b for a, b in pairwise(curves)]
    return curves[0]
