"""demo_OC_LQT_infHor01: discrete infinite-horizon regulation, precision on position alone.

Look for: one gain for all time. As the step shrinks it tends to the closed form of
Section 6, stiffness (Λ/r)^(1/2) and damping (2 stiffness)^(1/2), a damping ratio of 0.71.
"""

import numpy as np

from tpsim import impedance, impedance_of, integrator, lqr

PRECISION, EFFORT, STEPS = np.array([[4.0, 1.0], [1.0, 1.0]]), 0.04, (0.1, 0.01, 0.001)


def solve():
    """Stiffness and damping for each time step."""
    Q = np.zeros((4, 4))
    Q[:2, :2] = PRECISION
    return {dt: impedance_of(lqr(integrator(2, dt, exact=True), Q, EFFORT)) for dt in STEPS}


def path(dt, T=5.0):
    """Way back to the origin from (1, 1)."""
    system, state = integrator(2, dt, exact=True), np.array([1.0, 1.0, 0.0, 0.0])
    gain = np.hstack(solve()[dt])
    states = [state]
    for _ in range(int(T / dt)):
        states.append(system.step(states[-1], -gain @ states[-1]))
    return np.array(states)


def main() -> dict:
    stiffness, damping = impedance(PRECISION, EFFORT)
    figures = {"end": float(np.linalg.norm(path(0.01)[-1, :2]))}
    for dt, (K, D) in solve().items():
        figures[f"stiffness_gap_{dt:g}"] = float(np.abs(K - stiffness).max())
        figures[f"damping_gap_{dt:g}"] = float(np.abs(D - damping).max())
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    for dt in STEPS:
        plt.plot(*path(dt)[:, :2].T, label=f"dt = {dt:g} s")
    plt.axis("equal")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
