"""Demonstrations as a hand draws them: uneven in time, shaky, in scaled and reflected frames."""

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.examples import EXIT, u_frames
from tpsim.frame import Frame
from tpsim.section8.families import BEND

SCALE = 0.1**0.5  # of the frames of the tutorial's data, whose second one is a reflection
UNEVEN = 0.1  # spread of the logarithm of how much later the middle is reached
SHAKE = 0.03  # of the slow wander of the hand [m]


def hand_drawn(count: int, samples: int = 100, seed: int = 0) -> list[Demonstration]:
    """Draw demonstrations of the planar transfer of the same shape as the tutorial's data.

    Four of them make a set like that behind Fig. 12: two frames, A = sqrt(0.1) times a rotation
    and a reflection, one number of samples, no two at the same pace.

    Parameters
    ----------
    count : int
        Number of demonstrations.
    samples : int
        Number of samples T of each.
    seed : int
        The same seed gives the same demonstrations.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(2,)))
    return [_drawn(rng, samples) for _ in range(count)]


def _drawn(rng: np.random.Generator, samples: int) -> Demonstration:
    first, second = u_frames(rng)
    leave, enter = (frame.b + EXIT * frame.A[:, 1] for frame in (first, second))
    aside = np.array([rng.normal(0, BEND / 2), 0.4 + rng.uniform(-BEND, BEND)])
    points = np.array([first.b, leave, 0.5 * (leave + enter) + aside, enter, second.b])
    time = np.linspace(0.0, 1.0, samples)
    data = _curve(points, _pace(rng, time)) + _wander(rng, time)
    mirror = np.diag([1.0, -1.0])
    frames = Frame(SCALE * first.A, first.b), Frame(SCALE * second.A @ mirror, second.b)
    return Demonstration(2.0 * time, data, frames)


def _pace(rng: np.random.Generator, time: NDArray) -> NDArray:
    """Progress (T,) from 0 to 1, unevenly, slower at both ends."""
    uneven = time ** np.exp(rng.normal(0, UNEVEN))
    uneven = np.clip(uneven + rng.normal(0, UNEVEN / 3) * uneven * (1 - uneven), 0, 1)
    return np.asarray(0.6 * uneven**3 * (10 - 15 * uneven + 6 * uneven**2) + 0.4 * uneven)


def _wander(rng: np.random.Generator, time: NDArray, bumps: int = 6) -> NDArray:
    weights = np.exp(-0.5 * ((time[:, None] - np.linspace(0, 1, bumps)) / 0.12) ** 2)
    weights /= weights.sum(1, keepdims=True)
    return np.asarray(weights @ rng.normal(0, SHAKE, (bumps, 2)))


def _curve(points: NDArray, progress: NDArray) -> NDArray:
    """Bezier curve (T, D) of five points."""
    s = progress[:, None]
    shares = [1, 4, 6, 4, 1]
    powers = [share * s**k * (1 - s) ** (4 - k) for k, share in enumerate(shares)]
    return np.asarray(sum(power * point for power, point in zip(powers, points, strict=True)))
