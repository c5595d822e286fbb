"""What a comparison asks of a method: learn from demonstrations, then retrieve for frames."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian

Frames = Sequence[Frame | None]
"""The frames of a situation; None where one is not observed."""

Path = Gaussian | NDArray
"""A movement: Gaussian (T, D), or an array (T, D) from a method without a distribution."""

Retrieve = Callable[[Frames], Path]
"""From the frames of a situation to the movement, at the times of the demonstrations."""

Method = Callable[[list[Demonstration]], Retrieve]
"""Learns from demonstrations on one clock (:func:`tpsim.retrieval.clock.on_one_clock`)."""

RIDGE = 1e-6  # of where a movement starts and ends [m^2]


@dataclass(frozen=True, eq=False)
class Learned:
    """A retrieval that also knows how many numbers it keeps.

    Parameters
    ----------
    retrieve : function of frames
    parameters : int
        Free parameters of a model, or numbers of stored data.
    """

    retrieve: Retrieve
    parameters: int

    def __call__(self, frames: Frames) -> Path:
        """Movement in the frames of a situation."""
        return self.retrieve(frames)


@dataclass(frozen=True, eq=False)
class Anchor:
    """Where the demonstrations are at one step, as the frame that knows it best sees it.

    Parameters
    ----------
    step : int
        0 for the start, -1 for the end; where frames move, they are taken there.
    views : for every frame, its number, point (d,) and covariance (d, d), the narrowest first.
    """

    step: int
    views: tuple[tuple[int, Gaussian], ...]

    @classmethod
    def at(cls, demonstrations: Sequence[Demonstration], step: int) -> "Anchor":
        """Find the frame in which demonstrations are closest together at a step."""
        views = []
        for j in range(len(demonstrations[0].frames)):
            points = np.array([views_of(d)[j][step] for d in demonstrations])
            apart = points - points.mean(0)
            covariance = apart.T @ apart / max(len(points) - 1, 1)
            covariance += RIDGE * np.eye(points.shape[1])
            size = np.mean(
                [np.linalg.norm(_then(d.frames[j], step).A) ** 2 for d in demonstrations]
            )
            views.append((size * np.trace(covariance), j, Gaussian(points.mean(0), covariance)))
        ordered = sorted(views, key=lambda view: view[0])
        return cls(step, tuple((j, gaussian) for _, j, gaussian in ordered))

    def __call__(self, frames: Frames) -> Gaussian:
        """Point (D,) of a new situation, with its covariance, by the best frame that is seen."""
        for j, gaussian in self.views:
            if (frame := frames[j]) is not None:
                then = _then(frame, self.step)
                return gaussian.affine(then.A, then.b)
        raise ArgumentError("all frames are None; at least one must be observed")


def _then(frame: Frame, step: int) -> Frame:
    """Frame at a step, where it moves."""
    return frame[step] if frame.shape else frame


def views_of(demonstration: Demonstration) -> tuple[NDArray, ...]:
    """What each frame saw, (T, d_j)."""
    return demonstration.observations


def times_of(demonstrations: Sequence[Demonstration]) -> NDArray:
    """Times (T,) of demonstrations on one clock [s]."""
    return np.asarray(demonstrations[0].time)


def every(frames: Frames) -> list[Frame]:
    """Frames of a situation, for a method that needs them all."""
    seen = [frame for frame in frames if frame is not None]
    if len(seen) < len(frames):
        raise ArgumentError("needs every frame: its task parameters have no missing entries")
    return seen
