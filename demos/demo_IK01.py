"""demo_IK01: forward and inverse kinematics of a planar arm, with a numerical Jacobian.

Look for: the hand goes straight to its target by dq = J⁺ dx, and the two Jacobians, from
differences and from the equations, move the arm alike.
"""

import numpy as np

from tpsim import PlanarChain
from tpsim.control.planar import numeric_jacobian
from tpsim.control.projection import pseudoinverse

ARM = PlanarChain((0.6, 0.6, 0.6))
START, TARGET = np.array([np.pi / 2, np.pi / 4, -np.pi / 4]), np.array([-0.8, 0.8])


def solve(jacobian, steps=100, gain=0.1):
    """Postures (steps + 1, 3) on the way to the target."""
    q = [START]
    for _ in range(steps):
        error = TARGET - ARM.position(q[-1])
        q.append(q[-1] + gain * pseudoinverse(jacobian(q[-1]), damping=0.05) @ error)
    return np.array(q)


def numeric(q):
    return numeric_jacobian(ARM.position, q)


def main() -> dict:
    q = solve(numeric)
    path = ARM.position(q)
    way = (TARGET - path[0]) / np.linalg.norm(TARGET - path[0])
    sideways = (path - path[0]) @ np.array([-way[1], way[0]])
    return {
        "end_error": float(np.linalg.norm(path[-1] - TARGET)),
        "largest_sideways": float(np.abs(sideways).max()),
        "numeric_minus_analytic": float(np.abs(q - solve(ARM.jacobian)).max()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    for points in ARM.points(solve(numeric))[::10]:
        plt.plot(*points.T, "o-", color="0.6")
    plt.plot(*TARGET, "rx")
    plt.axis("equal")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
