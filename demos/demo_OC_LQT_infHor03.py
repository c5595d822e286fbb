"""demo_OC_LQT_infHor03: continuous infinite-horizon tracking of a GMM of position and velocity.

Look for: every state of the mixture has its own regulator, stiff where the Gaussian is
narrow. The path follows the states with a lag, since no plan looks ahead.
"""

from functools import cache

import numpy as np
from _tracking import Reference

from tpsim import Gaussian, impedance_of, integrator, lqr, plot
from tpsim.gallery import present, within

EFFORT = 0.03
REFERENCE = Reference("G", 6, ridge=1e-3)


@cache
def solve():
    """Regulators (K, 2, 4) and the path (T, 4)."""
    mean, precision = REFERENCE.gmm.gaussians.mean, REFERENCE.gmm.gaussians.precision
    regulators = lqr(integrator(2), precision, EFFORT, discrete=False)
    dt, path = REFERENCE.taught[0].time[1], [REFERENCE.taught[0].data[0]]
    for k in REFERENCE.states[1:]:
        control = regulators.gain[k] @ (mean[k] - path[-1])
        velocity = path[-1][2:] + dt * control
        path.append(np.r_[path[-1][:2] + dt * velocity, velocity])
    return regulators, np.array(path)


def main():
    regulators, path = solve()
    stiffness, _ = impedance_of(regulators)
    greatest = np.linalg.eigvalsh(0.5 * (stiffness + stiffness.mT))[:, -1]
    covariance = REFERENCE.gmm.gaussians.marginal([0, 1]).covariance
    narrow = np.linalg.eigh(covariance)[1][:, :, 0]
    across = np.einsum("ki,kij,kj->k", narrow, stiffness, narrow)
    return {
        "rms_to_demonstration_m": REFERENCE.rms(path, 0.35, "no foresight: it lags and cuts"),
        "stiffness_across_over_greatest": within(
            (across / greatest).mean(), 0.7, 1.01, "1 where the narrow direction is the stiff one"
        ),
    }


def draw(figure):
    regulators, path = solve()
    (axis,) = plot.panels(figure, size=(4.2, 4.4))
    REFERENCE.draw(axis, {"path": path})
    stiffness = impedance_of(regulators)[0]
    means = REFERENCE.gmm.gaussians.mean[:, :2]
    springs = Gaussian(means, 2e-4 * (stiffness + stiffness.mT))
    plot.ellipses(axis, springs, plot.PALETTE[1], fill=0, label="root of the stiffness")
    plot.legend(figure, columns=2)


if __name__ == "__main__":
    present(__file__, main, draw)
