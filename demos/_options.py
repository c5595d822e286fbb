"""A movement with two options, in partial demonstrations, and a chain of the states it passes."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from tpsim import GMM, Demonstration, SemiMarkovChain

STEPS, DT = 180, 0.02
PIECES = (("upper", 0.0, 0.2), ("upper", 0.05, 0.95), ("lower", 0.05, 0.95), ("lower", 0.8, 1.0))
POINTS = np.array([(-2.0, -0.3), (-1.5, 0.3), (-1.0, 0.0), (-0.5, 0.5), (0.0, 0.8)])


def whole(option: str, shake: np.ndarray | float = 0.0) -> np.ndarray:
    """The whole movement (STEPS, 2) by one option, which nobody demonstrates."""
    points = np.vstack([POINTS, POINTS[-2::-1] * [-1, 1]])
    points[3:6, 1] *= 1 if option == "upper" else -1
    points += shake
    return CubicSpline(np.linspace(0, 1, len(points)), points)(np.linspace(0, 1, STEPS))


def pieces() -> list[np.ndarray]:
    """Partial demonstrations [x, dx], each (T, 4)."""
    rng = np.random.default_rng(4)
    shaken = [(whole(name, 0.015 * rng.standard_normal((9, 2))), a, b) for name, a, b in PIECES]
    cuts = [path[int(STEPS * a) : int(STEPS * b)] for path, a, b in shaken]
    return [Demonstration(DT * np.arange(len(x)), x).with_derivatives(1).data[:-1] for x in cuts]


def chain_of(gmm: GMM, data: Sequence[np.ndarray]) -> SemiMarkovChain:
    """Chain of the states as they follow each other in the pieces."""
    states = [gmm.responsibilities(piece).argmax(1) for piece in data]
    return SemiMarkovChain.through(states, gmm.components, spread=0.0)


def sample(chain: SemiMarkovChain, rng: np.random.Generator) -> np.ndarray:
    """Draw states until the stay in the last one, after which nothing follows, is over."""
    states = chain.sample(2 * STEPS, rng)
    last = int(np.flatnonzero(states != states[-1])[-1]) + 1
    return states[: last + int(chain.durations.mean[states[-1], 0])]
