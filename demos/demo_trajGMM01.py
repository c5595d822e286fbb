"""demo_trajGMM01: the smooth trajectory through random Gaussians (Section 5.2, Eqs 26-31).

Look for: a staircase of positions and velocities becomes one smooth path, whose spread is far
smaller than that of a state, because neighbouring steps tell each other where they are.
"""

import numpy as np

from tpsim import Gaussian, trajectory

DT, STEPS = 0.1, 200


def retrieve():
    """Draw 4 states of [x, dx], each held for a quarter of the movement."""
    rng = np.random.default_rng(7)
    means = np.c_[rng.normal(size=(4, 2)), rng.normal(scale=0.1, size=(4, 2))]
    covariance = np.diag([0.2, 0.2, 0.01, 0.01])
    states = np.arange(STEPS) * 4 // STEPS
    path = trajectory(means[states], np.tile(covariance, (STEPS, 1, 1)), DT, derivatives=1)
    return Gaussian(means[:, :2], np.tile(covariance[:2, :2], (4, 1, 1))), states, path


def main() -> dict:
    gaussians, states, path = retrieve()
    velocity = np.diff(path.mean, axis=0) / DT
    return {
        "largest_jump_of_the_reference": float(
            np.linalg.norm(np.diff(gaussians.mean[states], axis=0), axis=1).max()
        ),
        "largest_step_of_the_path": float(np.linalg.norm(velocity, axis=1).max() * DT),
        "spread_of_a_state": float(np.sqrt(gaussians.covariance.max())),
        "spread_of_the_path": float(np.sqrt(np.linalg.eigvalsh(path.covariance).max())),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_ellipses, draw_path

    gaussians, _, path = retrieve()
    axis = plt.figure().gca()
    draw_ellipses(axis, gaussians, "gray")
    draw_path(axis, path)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
