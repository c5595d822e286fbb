"""demo_OC_LQT_infHor04: discrete infinite-horizon tracking of a GMM of position and velocity.

Look for: the effort is so small that the gains of demo_OC_LQT_infHor03 would be unstable
at this time step; the discrete ones are softer and are not. The finite horizon, which sees the
next states come, stays closer to the demonstration.
"""

from functools import cache

import numpy as np
from _tracking import Reference

from tpsim import integrator, lqr, lqt, plot
from tpsim.gallery import present, within

EFFORT = 1e-3
REFERENCE = Reference("G", 6, ridge=1e-3)


@cache
def solve():
    """Path without and with foresight (T, 4), and the closed loops with both kinds of gains."""
    system, states, gaussians = REFERENCE.system, REFERENCE.states, REFERENCE.gmm.gaussians
    mean, precision = gaussians.mean, gaussians.precision
    discrete = lqr(system, precision, EFFORT)
    continuous = lqr(integrator(2), precision, EFFORT, discrete=False)
    path = [REFERENCE.taught[0].data[0]]
    for k in states[:-1]:
        path.append(system.step(path[-1], discrete.gain[k] @ (mean[k] - path[-1])))
    ahead = lqt(mean[states], precision[states], system, EFFORT).rollout(path[0])
    loops = [system.A - system.B @ regulators.gain for regulators in (discrete, continuous)]
    return np.array(path), ahead.states, [np.abs(np.linalg.eigvals(A)).max() for A in loops]


def main():
    path, ahead, (discrete, continuous) = solve()
    return {
        "rms_infinite_horizon_m": REFERENCE.rms(path, 0.3, "no foresight: it lags and cuts"),
        "rms_finite_horizon_m": REFERENCE.rms(ahead, 0.1, "it leaves before the state changes"),
        "radius_with_discrete_gains": within(
            discrete, 0, 1 - 1e-6, "stable: inside the unit circle"
        ),
        "radius_with_continuous_gains": within(
            continuous, 1.0, 10, "gains that ask for more than a step of 0.01 s can give"
        ),
    }


def draw(figure):
    path, ahead, _ = solve()
    (axis,) = plot.panels(figure, size=(4.2, 4.4))
    REFERENCE.draw(axis, {"infinite horizon": path, "finite horizon": ahead})
    plot.legend(figure, columns=2)


if __name__ == "__main__":
    present(__file__, main, draw)
