"""demo_OC_LQT_infHor02: discrete infinite-horizon regulation, precision on position and velocity.

Look for: the more precise the velocity at rest, the slower the return and the larger the
damping ratio; with precision on position alone the return overshoots.
"""

from functools import cache

import numpy as np

from tpsim import impedance_of, integrator, lqr, plot
from tpsim.gallery import present, within

DT, EFFORT, WEIGHTS = 0.01, 0.04, (0.0, 1.0, 10.0)


@cache
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


def main():
    figures = {}
    for weight, (regulator, states) in solve().items():
        K, D = impedance_of(regulator)
        # Continuous time: k = (1/r)^(1/2), d = (w/r + 2 k)^(1/2).
        k = EFFORT**-0.5
        exact = np.sqrt(weight / EFFORT + 2 * k) / (2 * np.sqrt(k))
        figures[f"damping_ratio_{weight:g}"] = within(
            D[0, 0] / (2 * np.sqrt(K[0, 0])), 0.95 * exact, 1.05 * exact, "continuous time"
        )
        overshoot = np.exp(-np.pi) if exact < 1 else 0.0
        figures[f"overshoot_{weight:g}"] = within(
            max(0.0, -states[:, 0].min()),
            overshoot - 1e-3,
            overshoot + 1e-3,
            "exp(-π) at a ratio of 0.71, none above 1",
        )
    return figures


def draw(figure):
    (axis,) = plot.panels(figure, kind="curve", size=(5.0, 3.0))
    for (weight, (_, x)), colour in zip(solve().items(), plot.PALETTE, strict=False):
        label = f"velocity precision {weight:g}"
        axis.plot(DT * np.arange(len(x)), x[:, 0], color=colour, lw=1.8, label=label)
    axis.axhline(0, color=plot.INK, lw=1, ls="--")
    axis.set(xlabel="time [s]", ylabel="position [m]")
    plot.legend(figure, columns=1)


if __name__ == "__main__":
    present(__file__, main, draw)
