"""demo_IK01: forward and inverse kinematics of a planar arm, with a numerical Jacobian.

Look for: the hand goes straight to its target by dq = J⁺ dx, and the two Jacobians, from
differences and from the equations, move the arm alike.
"""

from functools import cache

import numpy as np

from tpsim import PlanarChain, plot
from tpsim.control.planar import numeric_jacobian
from tpsim.control.projection import pseudoinverse
from tpsim.gallery import present, within

ARM = PlanarChain((0.6, 0.6, 0.6))
START, TARGET = np.array([np.pi / 2, np.pi / 4, -np.pi / 4]), np.array([-0.8, 0.8])


def solve(jacobian, steps=100, gain=0.1):
    """Postures (steps + 1, 3) on the way to the target."""
    q = [START]
    for _ in range(steps):
        error = TARGET - ARM.position(q[-1])
        q.append(q[-1] + gain * pseudoinverse(jacobian(q[-1]), damping=0.05) @ error)
    return np.array(q)


@cache
def numeric():
    return solve(lambda q: numeric_jacobian(ARM.position, q))


def main():
    path = ARM.position(numeric())
    way = (TARGET - path[0]) / np.linalg.norm(TARGET - path[0])
    sideways = (path - path[0]) @ np.array([-way[1], way[0]])
    return {
        "end_error_m": within(
            np.linalg.norm(path[-1] - TARGET), 0, 1e-4, "0.9 of the error is left a step: 0.9^100"
        ),
        "largest_sideways_m": within(
            np.abs(sideways).max(), 0, 0.05, "straight but for the curvature within a step"
        ),
        "numeric_minus_analytic_rad": within(
            np.abs(numeric() - solve(ARM.jacobian)).max(), 0, 1e-8, "differences of step 1e-6"
        ),
    }


def draw(figure):
    (axis,) = plot.panels(figure, size=(4.0, 4.0))
    plot.arm(axis, ARM, numeric()[[0, 2, 5, 9, 15, 100]], label="arm, from light to dark")
    axis.plot(*ARM.position(numeric()).T, color=plot.PALETTE[1], label="path of the hand", zorder=3)
    plot.points(axis, TARGET, plot.PALETTE[1], marker="X", label="target")
    axis.set(xlabel="x [m]", ylabel="y [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
