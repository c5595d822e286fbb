"""demo_IK_expForm01: forward and inverse kinematics of a planar arm, with analytical Jacobian.

Look for: the hand turns to an angle and holds its place, by one Jacobian that stacks position
and orientation; a second run moves the elbow in the nullspace and the hand does not stir.
"""

import numpy as np

from tpsim import PlanarChain
from tpsim.control.projection import nullspace, pseudoinverse

ARM = PlanarChain((0.5, 0.5, 0.4, 0.3))
START, ANGLE = np.array([0.4, 0.9, 0.5, 0.3]), 1.2


def turn(steps=150, gain=0.1):
    """Postures that turn the hand to ANGLE on the spot."""
    place, q = ARM.position(START), [START]
    for _ in range(steps):
        J = np.vstack([ARM.jacobian(q[-1]), ARM.orientation_jacobian(q[-1])])
        error = np.r_[place - ARM.position(q[-1]), ANGLE - ARM.orientation(q[-1])]
        q.append(q[-1] + gain * pseudoinverse(J, damping=0.05) @ error)
    return np.array(q)


def swing(steps=150, speed=0.01):
    """Postures that move the elbow and leave the hand where it is."""
    place, q = ARM.position(START), [START]
    for _ in range(steps):
        J = ARM.jacobian(q[-1])
        back = pseudoinverse(J) @ (place - ARM.position(q[-1]))
        q.append(q[-1] + back + nullspace(J) @ np.array([speed, 0.0, 0.0, 0.0]))
    return np.array(q)


def main() -> dict:
    turned, swung, place = turn(), swing(), ARM.position(START)
    elbow = ARM.points(swung)[:, 1]
    return {
        "angle_error": float(np.abs(ARM.orientation(turned[-1]) - ANGLE).item()),
        "hand_moved_by_turning": float(np.abs(ARM.position(turned[-1]) - place).max()),
        "hand_moved_by_the_elbow": float(np.abs(ARM.position(swung) - place).max()),
        "elbow_travel": float(np.linalg.norm(np.diff(elbow, axis=0), axis=1).sum()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    for axis, q in zip(plt.subplots(1, 2)[1], (turn(), swing()), strict=True):
        for points in ARM.points(q)[::15]:
            axis.plot(*points.T, "o-", color="0.6")
        axis.set_aspect("equal")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
