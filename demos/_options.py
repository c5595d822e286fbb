"""A movement with two options, in partial demonstrations, and a chain of the states it passes."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline

from tpsim import GMM, Demonstration, Gaussian, SemiMarkovChain

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
    """Chain of the states as they follow each other in the pieces, all that follow equally likely.

    A piece may begin or end within a stay: where there are whole ones, they alone tell the duration
    of a state, and otherwise the longest does.
    """
    K = gmm.components
    follows, parts = np.zeros((K, K)), np.ones((K, 1))
    stays: list[list[int]] = [[] for _ in range(K)]
    sequences = [gmm.responsibilities(piece).argmax(1) for piece in data]
    for states in sequences:
        changes = np.flatnonzero(np.diff(states)) + 1
        follows[states[changes - 1], states[changes]] = 1
        first, *inner, last = np.split(states, changes)
        for stay in (first, last):
            parts[stay[0]] = max(parts[stay[0], 0], len(stay))
        for stay in inner:
            stays[stay[0]].append(len(stay))
    start = np.eye(K)[sequences[0][0]]
    chances = follows / np.maximum(follows.sum(1, keepdims=True), 1)
    whole_ones = zip(stays, parts, strict=True)
    mean = np.array([[np.mean(stay)] if stay else part for stay, part in whole_ones])
    return SemiMarkovChain(start, chances, Gaussian(mean, np.ones((K, 1, 1))))


def sample(chain: SemiMarkovChain, rng: np.random.Generator) -> np.ndarray:
    """Draw states until the stay in the last one, after which nothing follows, is over."""
    states = chain.sample(2 * STEPS, rng)
    last = int(np.flatnonzero(states != states[-1])[-1]) + 1
    return states[: last + int(chain.durations.mean[states[-1], 0])]
