"""demo_IK02: inverse kinematics with a nullspace projection operator, on two arms.

Look for: the left hand follows its circle; the right one, in the nullspace, while it can reach.
"""

from functools import cache

import numpy as np

from tpsim import plot, two_armed
from tpsim.control.projection import nullspace, pseudoinverse
from tpsim.gallery import present, within

LEFT, RIGHT = two_armed((0.6,) * 5)
START = np.array([np.pi / 2, np.pi / 2, np.pi / 3, -np.pi / 2, -np.pi / 3])
GAIN, DAMPING, CLIP, STEPS = 0.5, 0.1, 0.05, 1000
ANGLE = np.linspace(0, 2 * np.pi, STEPS)
CIRCLE = np.c_[np.cos(ANGLE) - 1, np.sin(ANGLE)]
# The right circle leaves the reach of the arm.
TARGETS = LEFT.position(START) + 0.2 * CIRCLE, RIGHT.position(START) - 0.4 * CIRCLE


@cache
def solve():
    """Postures (STEPS, 5), each a step dq = J⁺ e + N J~⁺ e~ after the last."""
    q = [START]
    for left, right in zip(*TARGETS, strict=True):
        J, J_other = LEFT.jacobian(q[-1]), RIGHT.jacobian(q[-1])
        error, other = left - LEFT.position(q[-1]), right - RIGHT.position(q[-1])
        other = other / max(1.0, np.linalg.norm(other) / CLIP)
        second = nullspace(J) @ pseudoinverse(J_other, DAMPING) @ other
        q.append(q[-1] + GAIN * (pseudoinverse(J, DAMPING) @ error + second))
    return np.array(q[1:])


def main():
    reached = LEFT.position(solve()), RIGHT.position(solve())
    first, second = np.linalg.norm(np.subtract(reached, TARGETS), axis=2)
    return {
        "largest_error_first_m": within(
            first.max(), 0, 0.005, "the second task acts in the nullspace of the first"
        ),
        "largest_error_second_m": within(second.max(), 0.3, 1.5, "its circle is out of reach"),
        "last_error_second_m": within(second[-1], 0, 0.005, "back where both can be reached"),
    }


def draw(figure):
    (axis,) = plot.panels(figure, size=(5.6, 4.4))
    sides = zip((LEFT, RIGHT), TARGETS, plot.PALETTE, ("first", "second"), strict=False)
    for arm, target, colour, name in sides:
        plot.arm(axis, arm, solve()[[0, 150, 300, 500]], colour, label=f"arm of the {name} task")
        axis.plot(*target.T, "--", color=colour, label=f"circle of the {name} hand")
        path = arm.position(solve())
        axis.plot(*path.T, color=plot.INK, lw=1.2, label="paths of the hands", zorder=3)
    axis.set(xlabel="x [m]", ylabel="y [m]")
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
