"""The tutorial's planar example, live: frames that people move, and what methods make of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations, u_frames
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.retrieval.clock import on_one_clock
from tpsim.section8.method import Path, Retrieve
from tpsim.section8.methods import METHODS

OFFERED = (
    "TP-GMR",
    "TP-LQT",
    "TP-trajGMM",
    "TP-ProMP",
    "TP-GP",
    "TP-LWR",
    "GPR",
    "PGMM",
    "DMP",
)
"""Methods that move along with the frames, by the names of ``tpsim compare``."""

FIRST = ("TP-GMR", "TP-LQT")
"""Those that are shown at first."""

SAMPLES = 100
"""Of a movement."""


@dataclass(frozen=True)
class Situation:
    """What comes out for some frames.

    Parameters
    ----------
    components : Gaussian (K, 2)
        The TP-GMM in these frames, Eqs (5-6) [m].
    paths : mapping of str to Gaussian (T, 2) or (T, 2)
        Of every method [m].
    """

    components: Gaussian
    paths: dict[str, Path]


class Plane:
    """Demonstrations of Figs 1, 2 and 12, and what is learned from them.

    Parameters
    ----------
    count : int
        Demonstrations.
    components : int
        Of the TP-GMM whose ellipses are drawn.

    Attributes
    ----------
    demonstrations : list of Demonstration
    frames : list of Frame
        Where the two objects are now.
    methods : tuple of str
        Those that retrieve now.
    """

    def __init__(self, count: int = 4, components: int = 3):
        self.methods: tuple[str, ...] = FIRST
        self.frames = list(u_frames(np.random.default_rng(3), spread=1.5))
        self.learn(count, components)

    def learn(self, count: int, components: int) -> None:
        """Learn anew from so many demonstrations."""
        if count < 2:
            raise ArgumentError(f"{count} demonstrations were asked for; give at least 2")
        self.demonstrations = on_one_clock(u_demonstrations(count, SAMPLES))
        self.model = fit_tp_gmm(self.demonstrations, components, start="time")
        self._learned: dict[str, Retrieve] = {}
        self.choose(self.methods)

    def choose(self, methods: Sequence[str]) -> None:
        """Let these methods retrieve; each learns when it is first chosen."""
        if unknown := [name for name in methods if name not in OFFERED]:
            raise ArgumentError(f"no method '{unknown[0]}'; there are {', '.join(OFFERED)}")
        for name in methods:
            if name not in self._learned:
                self._learned[name] = METHODS[name](self.demonstrations)
        self.methods = tuple(methods)

    def move(self, index: int, position: ArrayLike, angle: float) -> None:
        """Put one of the two objects somewhere else.

        Parameters
        ----------
        index : int
            0 for the first.
        position : (2,)
            [m]
        angle : float
            [rad]
        """
        c, s = float(np.cos(angle)), float(np.sin(angle))
        self.frames[index] = Frame(np.array([[c, -s], [s, c]]), np.array(position, float))

    def retrieve(self) -> Situation:
        """What all methods make of the frames as they are now."""
        paths = {name: self._learned[name](self.frames) for name in self.methods}
        return Situation(self.model.adapt(self.frames).gaussians, paths)


def tube(path: Gaussian, deviations: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Both edges (T, 2) of a movement's deviation across it."""
    along = np.gradient(path.mean, axis=0)
    size = np.linalg.norm(along, axis=1, keepdims=True)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.maximum(size, 1e-12)
    wide = np.sqrt(np.einsum("ti,tij,tj->t", across, path.covariance, across))
    offset = deviations * wide[:, None] * across
    return path.mean + offset, path.mean - offset
