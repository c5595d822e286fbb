"""demo_OC_LQT_recursive02: recursive LQT of a GMM of position and velocity, against batch LQT.

Look for: dynamic programming and one banded least squares problem give the same path, to
rounding; the recursion also answers from any other start.
"""

import numpy as np

from tpsim import fit_gmm, integrator, lqt, lqt_batch
from tpsim.examples import letters

EFFORT = 1e-5


def solve():
    """Demonstrations, batch plan, and roll-outs of the feedback from three starts."""
    taught = [demonstration.with_derivatives(1) for demonstration in letters("S", count=3)]
    gmm = fit_gmm([d.data for d in taught], 5, start="time")
    states = gmm.responsibilities(taught[0].data).argmax(axis=1)
    reference = gmm.gaussians[states]
    system, start = integrator(2, taught[0].time[1]), taught[0].data[0]
    feedback = lqt(reference.mean, reference.precision, system, EFFORT)
    batch = lqt_batch(reference.mean, reference.precision, system, EFFORT, start)
    aside = [np.zeros(4), np.array([0.3, 0.0, 0.0, 0.0]), np.array([0.0, -0.3, 0.0, 0.0])]
    return taught, batch, [feedback.rollout(start + offset) for offset in aside]


def main() -> dict:
    _, batch, rollouts = solve()
    return {
        "batch_minus_recursive": float(np.abs(batch.states - rollouts[0].states).max()),
        "ends_apart": float(np.ptp([plan.states[-1, :2] for plan in rollouts], axis=0).max()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    taught, batch, rollouts = solve()
    draw_demonstrations(plt.gca(), taught)
    for plan in rollouts:
        plt.plot(*plan.states[:, :2].T, "r")
    plt.plot(*batch.states[:, :2].T, "k--")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
