"""demo_OC_LQT01: batch LQT through via points, with one, two or three integrators (Eq. 37).

Look for: only three moments have a precision, all others are free. One integrator draws
straight lines between the points, two draw cubic splines, three smoother curves still.
"""

import numpy as np

from tpsim import integrator, lqt_batch

DT, T, EFFORT = 0.01, 201, 1e-8
VIA = {66: [0.5, 1.0], 133: [1.0, -0.5], 200: [1.5, 0.5]}


def solve():
    """Plans for 1, 2 and 3 integrators, with their covariances."""
    plans = {}
    for order in (1, 2, 3):
        system = integrator(2, DT, order, exact=True)
        n = 2 * order
        means, precisions = np.zeros((T, n)), np.zeros((T, n, n))
        for t, point in VIA.items():
            means[t, :2], precisions[t, :2, :2] = point, np.eye(2)
        plans[order] = lqt_batch(means, precisions, system, EFFORT, np.zeros(n), covariance=True)
    return plans


def main() -> dict:
    figures = {}
    for order, plan in solve().items():
        missed = [np.linalg.norm(plan.states[t, :2] - point) for t, point in VIA.items()]
        figures[f"largest_miss_{order}"] = float(max(missed))
        between, at = plan.covariance[100, 0, 0], plan.covariance[66, 0, 0]
        figures[f"spread_between_over_at_{order}"] = float(np.sqrt(between / at))
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    for order, plan in solve().items():
        plt.plot(*plan.states[:, :2].T, label=f"{order} integrators")
    plt.plot(*np.array(list(VIA.values())).T, "ko")
    plt.axis("equal")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
