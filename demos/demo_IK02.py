"""demo_IK02: inverse kinematics with a nullspace projection operator, on two arms.

Look for: the left hand follows its circle; the right one, in the nullspace, while it can reach.
"""

import numpy as np

from tpsim import two_armed
from tpsim.control.projection import nullspace, pseudoinverse

LEFT, RIGHT = two_armed((0.6,) * 5)
START = np.array([np.pi / 2, np.pi / 2, np.pi / 3, -np.pi / 2, -np.pi / 3])
GAIN, DAMPING, CLIP = 0.5, 0.1, 0.05


def targets(steps):
    """Circles of the two hands (steps, 2); the right one leaves the reach of the arm."""
    angle = np.linspace(0, 2 * np.pi, steps)
    circle = np.c_[np.cos(angle) - 1, np.sin(angle)]
    return LEFT.position(START) + 0.2 * circle, RIGHT.position(START) - 0.4 * circle


def solve(steps=1000):
    """Postures (steps, 5), each a step dq = J⁺ e + N J~⁺ e~ after the last."""
    q = [START]
    for left, right in zip(*targets(steps), strict=True):
        J, J_other = LEFT.jacobian(q[-1]), RIGHT.jacobian(q[-1])
        error, other = left - LEFT.position(q[-1]), right - RIGHT.position(q[-1])
        other = other / max(1.0, np.linalg.norm(other) / CLIP)
        second = nullspace(J) @ pseudoinverse(J_other, DAMPING) @ other
        q.append(q[-1] + GAIN * (pseudoinverse(J, DAMPING) @ error + second))
    return np.array(q[1:])


def main() -> dict:
    q = solve()
    reached = LEFT.position(q), RIGHT.position(q)
    first, second = np.linalg.norm(np.subtract(reached, targets(len(q))), axis=2)
    return {
        "largest_error_of_first_priority": float(first.max()),
        "largest_error_of_second_priority": float(second.max()),
        "last_error_of_second_priority": float(second[-1]),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    q = solve()
    for arm, target in zip((LEFT, RIGHT), targets(len(q)), strict=True):
        plt.plot(*target.T, "r")
        for points in arm.points(q)[::50]:
            plt.plot(*points.T, "o-", color="0.6")
    plt.axis("equal")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
