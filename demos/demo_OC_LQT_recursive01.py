"""demo_OC_LQT_recursive01: recursive LQT, with feedback and feedforward terms.

Look for: one backward pass gives gains for any state. A push moves the path aside; where
the precision is low the controller lets it be, and is back where the precision is high.
"""

from functools import cache

import numpy as np

from tpsim import integrator, lqt, plot
from tpsim.gallery import present, within

DT, T, EFFORT, PUSHED = 0.01, 200, 1e-3, 70
SOFT = (0.25, 0.6)  # share of the movement in which the precision is low


@cache
def solve():
    """Stiffness over time, the plan, and the path with a push at step 70."""
    time = np.linspace(0.0, 1.0, T)
    means = np.c_[time, np.sin(2 * np.pi * time), np.zeros((T, 2))]
    importance = np.where((time > SOFT[0]) & (time < SOFT[1]), 0.1, 100.0)
    precisions = importance[:, None, None] * np.diag([1.0, 1.0, 0.0, 0.0])
    feedback = lqt(means, precisions, integrator(2, DT), EFFORT)
    plan, pushed = feedback.rollout(means[0]), [means[0]]
    for t in range(T - 1):
        state = pushed[-1] + (np.array([0.0, 0.3, 0.0, 0.0]) if t == PUSHED else 0.0)
        pushed.append(feedback.system.step(state, feedback.control(t, state)))
    return feedback.gain[:, 0, 0], plan.states, np.array(pushed)


def main():
    stiffness, planned, pushed = solve()
    aside = np.linalg.norm((pushed - planned)[:, :2], axis=1)
    return {
        "stiff_over_soft": within(
            stiffness[20] / stiffness[PUSHED], 5, 32, "precision 1000 times: at most its root"
        ),
        "aside_after_0.1_s_m": within(
            aside[PUSHED + 10], 0.2, 0.3, "low precision: most of the 0.3 m remains"
        ),
        "aside_at_the_end_m": within(aside[-1], 0, 1e-3, "high precision in the last 0.8 s"),
    }


def draw(figure):
    stiffness, planned, pushed = solve()
    time, names = DT * np.arange(T), ("y [m]", "stiffness [1/s²]")
    axes = plot.panels(figure, 1, 2, kind="curve", size=(3.6, 2.8))
    axes[0].plot(time, planned[:, 1], color=plot.INK, lw=1.8, label="planned")
    axes[0].plot(time, pushed[:, 1], "--", color=plot.PALETTE[1], lw=1.8, label="pushed")
    axes[1].plot(time[:-1], stiffness[: T - 1], color=plot.PALETTE[0], lw=1.8)
    for axis, name in zip(axes, names, strict=True):
        axis.axvspan(*(T * DT * np.array(SOFT)), color=plot.INK, alpha=0.07, label="low precision")
        axis.set(xlabel="time [s]", ylabel=name)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
