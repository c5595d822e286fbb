"""demo_OC_LQT_infHor04: discrete infinite-horizon tracking of a GMM of position and velocity.

Look for: the effort is so small that the gains of demo_OC_LQT_infHor03 would be unstable
at this time step; the discrete ones are softer and are not. The finite horizon, which sees the
next states come, stays closer to the demonstration.
"""

import numpy as np

from tpsim import fit_gmm, integrator, lqr, lqt
from tpsim.examples import letters

COMPONENTS, EFFORT = 6, 1e-3


def solve():
    """Demonstrations, path without and with foresight (T, 4), and the gap of the gains."""
    taught = [demonstration.with_derivatives(1) for demonstration in letters("G")]
    gmm = fit_gmm([d.data for d in taught], COMPONENTS, start="time", ridge=1e-3)
    states = gmm.responsibilities(taught[0].data).argmax(axis=1)
    system = integrator(2, taught[0].time[1])
    mean, precision = gmm.gaussians.mean, gmm.gaussians.precision
    regulators = lqr(system, precision, EFFORT)
    path = [taught[0].data[0]]
    for k in states[:-1]:
        path.append(system.step(path[-1], regulators.gain[k] @ (mean[k] - path[-1])))
    ahead = lqt(mean[states], precision[states], system, EFFORT).rollout(path[0])
    continuous = lqr(integrator(2), precision, EFFORT, discrete=False)
    gap = np.abs(regulators.gain - continuous.gain).max() / np.abs(continuous.gain).max()
    return taught, np.array(path), ahead.states, gap


def main() -> dict:
    taught, path, ahead, gap = solve()
    figures = {"gain_gap_to_continuous": float(gap)}
    for name, states in (("infinite", path), ("finite", ahead)):
        error = np.linalg.norm(states[:, :2] - taught[0].data[:, :2], axis=1)
        figures[f"rms_{name}_horizon"] = float(np.sqrt(np.mean(error**2)))
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    taught, path, ahead, _ = solve()
    draw_demonstrations(plt.gca(), taught)
    plt.plot(*path[:, :2].T, "r", label="infinite horizon")
    plt.plot(*ahead[:, :2].T, "b", label="finite horizon")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
