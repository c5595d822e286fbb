"""demo_OC_LQT02: batch LQT of a stepwise reference from a GMM of position and velocity.

Look for: the reference jumps from state to state, the planned path rounds the jumps off
and spends its effort where the Gaussians are tight. More effort cost, rounder corners.
"""

import numpy as np

from tpsim import fit_gmm, integrator, lqt_batch
from tpsim.examples import letters

EFFORTS = (1e-5, 1e-3, 1e-1)


def solve():
    """Demonstrations, mixture, state sequence, and a plan for every effort."""
    taught = [demonstration.with_derivatives(1) for demonstration in letters("S")]
    gmm = fit_gmm([d.data for d in taught], 5, start="time")
    states = gmm.responsibilities(taught[0].data).argmax(axis=1)
    reference = gmm.gaussians[states]
    dt = taught[0].time[1]
    plans = {
        effort: lqt_batch(
            reference.mean, reference.precision, integrator(2, dt), effort, taught[0].data[0]
        )
        for effort in EFFORTS
    }
    return taught, gmm, plans


def main() -> dict:
    taught, _, plans = solve()
    figures = {}
    for effort, plan in plans.items():
        gap = np.linalg.norm(plan.states[:, :2] - taught[0].data[:, :2], axis=1)
        figures[f"rms_to_demonstration_{effort:g}"] = float(np.sqrt(np.mean(gap**2)))
        figures[f"largest_acceleration_{effort:g}"] = float(np.abs(plan.controls).max())
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    taught, gmm, plans = solve()
    draw_demonstrations(plt.gca(), taught)
    for effort, plan in plans.items():
        plt.plot(*plan.states[:, :2].T, label=f"effort {effort:g}")
    plt.plot(*gmm.gaussians.mean[:, :2].T, "k+")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
