"""demo_OC_LQT_infHor01: discrete infinite-horizon regulation, precision on position alone.

Look for: one gain for all time. As the step shrinks it tends to the closed form of
Section 6, stiffness (Λ/r)^(1/2) and damping (2 stiffness)^(1/2), a damping ratio of 0.71.
"""

from functools import cache

import numpy as np

from tpsim import impedance, impedance_of, integrator, lqr, plot
from tpsim.gallery import present, within

PRECISION, EFFORT, STEPS = np.array([[4.0, 1.0], [1.0, 1.0]]), 0.04, (0.1, 0.01, 0.001)


@cache
def solve():
    """Stiffness and damping for each time step."""
    Q = np.zeros((4, 4))
    Q[:2, :2] = PRECISION
    return {dt: impedance_of(lqr(integrator(2, dt, exact=True), Q, EFFORT)) for dt in STEPS}


def path(dt, T=5.0):
    """Way back to the origin from (1, 1)."""
    system, states = integrator(2, dt, exact=True), [np.array([1.0, 1.0, 0.0, 0.0])]
    gain = np.hstack(solve()[dt])
    for _ in range(int(T / dt)):
        states.append(system.step(states[-1], -gain @ states[-1]))
    return np.array(states)


def main():
    stiffness, damping = impedance(PRECISION, EFFORT)
    gaps = [[np.abs(K - stiffness).max(), np.abs(D - damping).max()] for K, D in solve().values()]
    end = np.linalg.norm(path(0.01)[-1, :2])
    figures = {"end_m": within(end, 0, 0.01, "5 s are ten time constants of the slow direction")}
    for name, (coarse, fine, finest) in zip(
        ("stiffness", "damping"), np.transpose(gaps), strict=True
    ):
        figures[f"{name}_gap_finest"] = within(finest, 0, 0.05, "tends to the closed form")
        figures[f"{name}_gap_falls_by"] = within(
            fine / finest, 8, 12, f"first order in the step: ten times finer, from {coarse:.2g}"
        )
    return figures


def draw(figure):
    plane, curve = plot.panels(figure, 1, 2, kind=["plane", "curve"])
    for dt, colour, style in zip(STEPS, plot.PALETTE, ("-", "--", ":"), strict=False):
        plane.plot(*path(dt)[:, :2].T, style, color=colour, lw=2, label=f"time step {dt:g} s")
    plot.points(plane, [0, 0], marker="X", label="target")
    plane.set(xlabel="x [m]", ylabel="y [m]")
    closed = impedance(PRECISION, EFFORT)
    for k, name in enumerate(("stiffness [1/s²]", "damping [1/s]")):
        gaps = [np.abs(found[k] - closed[k]).max() for found in solve().values()]
        curve.loglog(STEPS, gaps, "o-", color=plot.PALETTE[3 + k], label=name)
    curve.set(xlabel="time step [s]", ylabel="gap to the closed form")
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
