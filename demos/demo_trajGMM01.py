"""demo_trajGMM01: the smooth trajectory through random Gaussians (Section 5.2, Eqs 26-31).

Look for: a staircase of positions and velocities becomes one smooth path, whose spread is far
smaller than that of a state, because neighbouring steps tell each other where they are.
"""

from functools import cache

import numpy as np

from tpsim import Gaussian, plot, trajectory
from tpsim.gallery import present, within

DT, STEPS = 0.1, 200


@cache
def retrieve():
    """Draw 4 states of [x, dx], each held for a quarter of the movement."""
    rng = np.random.default_rng(259)
    means = np.c_[rng.normal(size=(4, 2)), rng.normal(scale=0.1, size=(4, 2))]
    covariance = np.diag([0.05, 0.05, 0.05, 0.05])
    states = np.arange(STEPS) * 4 // STEPS
    path = trajectory(means[states], np.tile(covariance, (STEPS, 1, 1)), DT, derivatives=1)
    return Gaussian(means[:, :2], np.tile(covariance[:2, :2], (4, 1, 1))), states, path


def main():
    gaussians, states, path = retrieve()
    jump = np.linalg.norm(np.diff(gaussians.mean[states], axis=0), axis=1).max()
    step = np.linalg.norm(np.diff(path.mean, axis=0), axis=1).max()
    spread = np.sqrt(np.linalg.eigvalsh(path.covariance).max() / gaussians.covariance.max())
    return {
        "largest_step_over_jump": within(step / jump, 0, 0.1, "smooth, where the reference jumps"),
        "spread_over_that_of_a_state": within(
            spread, 0.02, 0.6, "between 1 / sqrt(T), all steps as one, and independent steps"
        ),
    }


def draw(figure):
    gaussians, states, path = retrieve()
    plane, *curves = plot.panels(figure, 1, 3, kind=["plane", "curve", "curve"])
    plot.ellipses(plane, gaussians, fill=0.12, label="states")
    plot.tube(plane, path, label="trajectory, with its spread")
    plane.set(xlabel="x [m]", ylabel="y [m]")
    time = DT * np.arange(STEPS)
    for k, axis in enumerate(curves):
        axis.step(time, gaussians.mean[states, k], color=plot.PALETTE[0], lw=1.2, label="means")
        plot.band(axis, time, path.mean[:, k], np.sqrt(path.covariance[:, k, k]))
        axis.set(xlabel="time [s]", ylabel=f"{'xy'[k]} [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
