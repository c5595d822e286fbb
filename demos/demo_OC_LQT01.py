"""demo_OC_LQT01: batch LQT through via points, with one, two or three integrators (Eq. 37).

Look for: only three moments have a precision, all others are free. One integrator draws
straight lines between the points, two draw cubic splines, three smoother curves still.
"""

from functools import cache

import numpy as np

from tpsim import Gaussian, integrator, lqt_batch, plot
from tpsim.gallery import present, within

DT, T, EFFORT = 0.01, 201, 1e-8
VIA = {66: [0.5, 1.0], 133: [1.0, -0.5], 200: [1.5, 0.5]}


@cache
def solve():
    """Plans for 1, 2 and 3 integrators, with their covariances."""
    plans = {}
    for order in (1, 2, 3):
        n = 2 * order
        means, precisions = np.zeros((T, n)), np.zeros((T, n, n))
        for t, point in VIA.items():
            means[t, :2], precisions[t, :2, :2] = point, np.eye(2)
        system = integrator(2, DT, order, exact=True)
        plans[order] = lqt_batch(means, precisions, system, EFFORT, np.zeros(n), covariance=True)
    return plans


def main():
    figures = {}
    for order, plan in solve().items():
        missed = [np.linalg.norm(plan.states[t, :2] - point) for t, point in VIA.items()]
        between, at = plan.covariance[100, 0, 0], plan.covariance[66, 0, 0]
        figures[f"largest_miss_{order}_m"] = within(
            max(missed), 0, 0.01, "effort is cheap: 1e-8 beside a precision of 1"
        )
        figures[f"spread_between_over_at_{order}"] = within(
            np.sqrt(between / at), 5, 1000, "nothing holds the path between the points"
        )
    straight = solve()[1].states[:67, :2]
    away = np.abs(straight @ [1.0, -0.5]) / np.hypot(1, 0.5)
    figures["one_integrator_from_straight_m"] = within(
        away.max(), 0, 1e-4, "least effort of one integrator is constant velocity"
    )
    return figures


def draw(figure):
    axes = plot.panels(figure, 1, 3)
    for axis, (order, plan) in zip(axes, solve().items(), strict=True):
        scale = 0.3**2 / plan.covariance[:, :2, :2].max()
        position = Gaussian(plan.states, scale * plan.covariance).marginal([0, 1])
        plot.tube(axis, position, label="path, with its spread (scaled to 0.3 m)")
        plot.points(axis, list(VIA.values()), label="via points")
        plot.title(axis, f"{order} integrator{'s' if order > 1 else ''}")
        axis.set_xlabel("x [m]")
    axes[0].set_ylabel("y [m]")
    plot.same_view(axes)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
