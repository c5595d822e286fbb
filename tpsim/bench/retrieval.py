"""Speeds of retrieval: regression in batch and in a control loop, trajectories linear in time."""

from functools import partial

import numpy as np

from tpsim.bench import poses
from tpsim.bench.timing import median_time
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.retrieval.gmr import Regression, gmr
from tpsim.retrieval.trajectory import trajectory


def run(quick: bool = False) -> dict[str, float]:
    """Medians of regression (P = 3, K = 5, D = 4) and of trajectories (C = 3, D = 2).

    Parameters
    ----------
    quick
        Fewer repetitions.

    Returns
    -------
    Times, their unit at the end of the name, and the growth of the trajectory's time when it
    gets ten times longer.
    """
    repetitions = 20 if quick else 200
    figures = _regression(repetitions) | poses.retrieval(10 * repetitions)
    return figures | _trajectories(max(repetitions // 20, 3))


def _regression(repetitions: int) -> dict[str, float]:
    rng = np.random.default_rng(0)
    model = TPGMM(np.full(5, 0.2), tuple(_gaussians(rng, 5, 4) for _ in range(3)))
    frames = [Frame(np.eye(3), rng.normal(size=3)).with_input() for _ in range(3)]
    gmm, time, now = model.adapt(frames), np.linspace(0, 1, 200), np.array([0.3])
    regression = Regression.of(gmm)
    moved = [Frame(frames[0].A, rng.normal(size=4)), *frames[1:]]

    def follow() -> Gaussian:
        return Regression.of(model.adapt(moved)).at(now)

    return {
        "gmr_200_steps_ms": 1e3 * median_time(lambda: gmr(gmm, time), repetitions),
        "gmr_one_point_us": 1e6 * median_time(lambda: regression.at(now), 10 * repetitions),
        "gmr_one_point_moved_frame_us": 1e6 * median_time(follow, 10 * repetitions),
    }


def _trajectories(repetitions: int) -> dict[str, float]:
    short, long = (
        median_time(partial(trajectory, *_statistics(steps), 0.01), repetitions)
        for steps in (800, 8000)
    )
    return {
        "trajectory_800_steps_ms": 1e3 * short,
        "trajectory_8000_steps_ms": 1e3 * long,
        "trajectory_growth_for_10_times_the_steps": long / short,
    }


def _statistics(steps: int) -> tuple[np.ndarray, np.ndarray]:
    gaussians = _gaussians(np.random.default_rng(1), 5, 6)
    states = np.arange(steps) * 5 // steps
    return gaussians.mean[states], gaussians.covariance[states]


def _gaussians(rng: np.random.Generator, count: int, dim: int) -> Gaussian:
    root = rng.normal(size=(count, dim, dim))
    return Gaussian(rng.normal(size=(count, dim)), root @ root.mT + 0.1 * np.eye(dim))
