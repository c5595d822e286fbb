"""demo_OC_LQT_infHor02: discrete infinite-horizon regulation, precision on position and velocity.

Look for: the more precise the velocity at rest, the slower the return and the larger the
damping ratio; with precision on position alone the return overshoots.
"""

import numpy as np

from tpsim import impedance_of, integrator, lqr

DT, EFFORT, WEIGHTS = 0.01, 0.04, (0.0, 1.0, 10.0)


def solve():
    """Gains and way back from 1, for each precision of velocity."""
    system, results = integrator(1, DT, exact=True), {}
    for weight in WEIGHTS:
        regulator = lqr(system, np.diag([1.0, weight]), EFFORT)
        states = [np.array([1.0, 0.0])]
        for _ in range(800):
            states.append(system.step(states[-1], -regulator.gain @ states[-1]))
        results[weight] = regulator, np.array(states)
    return results


def main() -> dict:
    figures = {}
    for weight, (regulator, states) in solve().items():
        K, D = impedance_of(regulator)
        figures[f"damping_ratio_{weight:g}"] = float(D[0, 0] / (2 * np.sqrt(K[0, 0])))
        figures[f"overshoot_{weight:g}"] = float(max(0.0, -states[:, 0].min()))
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    for weight, (_, states) in solve().items():
        plt.plot(DT * np.arange(len(states)), states[:, 0], label=f"velocity precision {weight:g}")
    plt.xlabel("time [s]")
    plt.ylabel("position [m]")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
