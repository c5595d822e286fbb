"""demo_IK_expForm01: forward and inverse kinematics of a planar arm, with analytical Jacobian.

Look for: the hand turns to an angle and holds its place, by one Jacobian that stacks position
and orientation; a second run moves the elbow in the nullspace and the hand does not stir.
"""

from functools import cache

import numpy as np

from tpsim import PlanarChain, plot
from tpsim.control.projection import nullspace, pseudoinverse
from tpsim.gallery import present, within

ARM = PlanarChain((0.5, 0.5, 0.4, 0.3))
START, ANGLE = np.array([0.4, 0.9, 0.5, 0.3]), 1.2
PLACE = ARM.position(START)


@cache
def turn(steps=150, gain=0.1):
    """Postures that turn the hand to ANGLE on the spot."""
    q = [START]
    for _ in range(steps):
        J = np.vstack([ARM.jacobian(q[-1]), ARM.orientation_jacobian(q[-1])])
        error = np.r_[PLACE - ARM.position(q[-1]), ANGLE - ARM.orientation(q[-1])]
        q.append(q[-1] + gain * pseudoinverse(J, damping=0.05) @ error)
    return np.array(q)


@cache
def swing(steps=600, speed=0.005):
    """Postures that move the elbow and leave the hand where it is."""
    q = [START]
    for _ in range(steps):
        J = ARM.jacobian(q[-1])
        back = pseudoinverse(J) @ (PLACE - ARM.position(q[-1]))
        q.append(q[-1] + back + nullspace(J) @ np.array([speed, 0.0, 0.0, 0.0]))
    return np.array(q)


def main():
    still = "the task Jacobian holds the hand; a step's curvature is put right in the next"
    moved = {
        name: np.abs(ARM.position(q()) - PLACE) for name, q in (("turn", turn), ("elbow", swing))
    }
    elbow = np.linalg.norm(np.diff(ARM.points(swing())[:, 1], axis=0), axis=1).sum()
    return {
        "angle_error_rad": within(
            np.abs(ARM.orientation(turn()[-1]) - ANGLE).item(), 0, 1e-5, "0.9 left a step: 0.9^150"
        ),
        "hand_moved_by_turning_m": within(moved["turn"][-1].max(), 0, 1e-5, still),
        "hand_moved_by_the_elbow_m": within(moved["elbow"].max(), 0, 1e-5, still),
        "elbow_travel_m": within(elbow, 0.15, 1.0, "an elbow of 0.5 m has room to swing"),
    }


def draw(figure):
    axes = plot.panels(figure, 1, 2)
    shown = {"turn on the spot": turn()[[0, 3, 7, 15, 150]], "swing the elbow": swing()[::150]}
    for axis, (name, q) in zip(axes, shown.items(), strict=True):
        plot.arm(axis, ARM, q, label="arm, from light to dark")
        plot.points(axis, PLACE, plot.PALETTE[1], marker="X", label="place of the hand")
        plot.title(axis, name)
        axis.set_xlabel("x [m]")
    axes[0].set_ylabel("y [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
