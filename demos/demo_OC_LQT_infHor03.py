"""demo_OC_LQT_infHor03: continuous infinite-horizon tracking of a GMM of position and velocity.

Look for: every state of the mixture has its own regulator, stiff where the Gaussian is
narrow. The path follows the states with a lag, since no plan looks ahead.
"""

import numpy as np

from tpsim import fit_gmm, impedance_of, integrator, lqr
from tpsim.examples import letters

COMPONENTS, EFFORT = 6, 0.03


def solve():
    """Demonstrations, regulators (K, 2, 4) and the path (T, 4)."""
    taught = [demonstration.with_derivatives(1) for demonstration in letters("G")]
    gmm = fit_gmm([d.data for d in taught], COMPONENTS, start="time", ridge=1e-3)
    states = gmm.responsibilities(taught[0].data).argmax(axis=1)
    regulators = lqr(integrator(2), gmm.gaussians.precision, EFFORT, discrete=False)
    dt, path = taught[0].time[1], [taught[0].data[0]]
    for k in states[1:]:
        control = regulators.gain[k] @ (gmm.gaussians.mean[k] - path[-1])
        velocity = path[-1][2:] + dt * control
        path.append(np.r_[path[-1][:2] + dt * velocity, velocity])
    return taught, regulators, np.array(path)


def main() -> dict:
    taught, regulators, path = solve()
    stiffness, _ = impedance_of(regulators)
    values = np.linalg.svd(stiffness, compute_uv=False)
    gap = np.linalg.norm(path[:, :2] - taught[0].data[:, :2], axis=1)
    return {
        "rms_to_demonstration": float(np.sqrt(np.mean(gap**2))),
        "largest_stiffness_ratio": float((values[:, 0] / values[:, 1]).max()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    taught, _, path = solve()
    draw_demonstrations(plt.gca(), taught)
    plt.plot(*path[:, :2].T, "r")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
