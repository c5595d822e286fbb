"""demo_OC_LQT_recursive03: recursive LQT of a GMM of positions alone.

Look for: velocities have no precision (the weights are singular), so the controller finds
them; the path is smooth although the reference steps from mean to mean.
"""

import numpy as np

from tpsim import fit_gmm, integrator, lqt
from tpsim.examples import letters

EFFORT = 1e-3


def solve():
    """Demonstrations, stepwise reference (T, 2) and plan."""
    taught = letters("C", samples=100)
    gmm = fit_gmm([d.data for d in taught], 8, start="time")
    states = gmm.responsibilities(taught[0].data).argmax(axis=1)
    reference, T = gmm.gaussians[states], len(states)
    means, precisions = np.zeros((T, 4)), np.zeros((T, 4, 4))
    means[:, :2], precisions[:, :2, :2] = reference.mean, reference.precision
    feedback = lqt(means, precisions, integrator(2, taught[0].time[1]), EFFORT)
    start = np.r_[taught[0].data[0], 0.0, 0.0]
    return taught, reference.mean, feedback.rollout(start)


def main() -> dict:
    taught, reference, plan = solve()
    path = plan.states[:, :2]
    gap = np.linalg.norm(path - taught[0].data, axis=1)
    return {
        "rms_to_demonstration": float(np.sqrt(np.mean(gap**2))),
        "largest_step_of_reference": float(np.abs(np.diff(reference, axis=0)).max()),
        "largest_step_of_path": float(np.abs(np.diff(path, axis=0)).max()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    taught, reference, plan = solve()
    draw_demonstrations(plt.gca(), taught)
    plt.plot(*reference.T, "k+")
    plt.plot(*plan.states[:, :2].T, "r")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
