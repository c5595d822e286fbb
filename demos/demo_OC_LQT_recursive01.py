"""demo_OC_LQT_recursive01: recursive LQT, with feedback and feedforward terms.

Look for: one backward pass gives gains for any state. A push moves the path aside; where
the precision is low the controller lets it be, and is back where the precision is high.
"""

import numpy as np

from tpsim import integrator, lqt

DT, T, EFFORT, PUSHED = 0.01, 200, 1e-3, 70


def solve():
    """Stiffness over time, the plan, and the path with a push at step 70."""
    time = np.linspace(0.0, 1.0, T)
    means = np.c_[time, np.sin(2 * np.pi * time), np.zeros((T, 2))]
    importance = np.where((time > 0.25) & (time < 0.6), 0.1, 100.0)
    precisions = importance[:, None, None] * np.diag([1.0, 1.0, 0.0, 0.0])
    feedback = lqt(means, precisions, integrator(2, DT), EFFORT)
    plan = feedback.rollout(means[0])
    pushed = [means[0]]
    for t in range(T - 1):
        state = pushed[-1] + (np.array([0.0, 0.3, 0.0, 0.0]) if t == PUSHED else 0.0)
        pushed.append(feedback.system.step(state, feedback.control(t, state)))
    return feedback.gain[:, 0, 0], plan.states, np.array(pushed)


def main() -> dict:
    stiffness, planned, pushed = solve()
    aside = np.linalg.norm((pushed - planned)[:, :2], axis=1)
    return {
        "stiffness_where_soft": float(stiffness[PUSHED]),
        "stiffness_where_stiff": float(stiffness[20]),
        "aside_after_0.1_s": float(aside[PUSHED + 10]),
        "aside_at_the_end": float(aside[-1]),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    stiffness, planned, pushed = solve()
    _, (left, right) = plt.subplots(1, 2)
    left.plot(*planned[:, :2].T, "k", *pushed[:, :2].T, "r")
    left.set_title("path, planned and pushed")
    right.plot(DT * np.arange(T), stiffness)
    right.set_title("stiffness over time")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
