"""demo_DMP_GMR_LQR01: a movement primitive whose spring and damper come from LQR.

Look for: the attractor is retrieved by TP-GMR with its covariance, whose inverse weighs the
tracking; the arm is stiff where the demonstrations agree and soft where they differ.
"""

import numpy as np

import tpsim
from tpsim import Demonstration, Frame, Motion, integrator, lqt
from tpsim.examples import letters

STIFFNESS, DAMPING, DT, EFFORT = 50.0, 10.0, 0.01, 1e-3
SHIFT = np.array([0.0, 1.5])


def retrieve():
    """Learn [s, attractor] in the frame of the goal, move the goal, track the attractor."""
    s, encoded = tpsim.decay(201, DT), []
    for d in letters("G", samples=201):
        attractor = tpsim.attractor_path(Motion.of(d.data, DT), STIFFNESS, DAMPING)
        goal = Frame(np.eye(2), d.data[-1])
        encoded.append(Demonstration(d.time, attractor, [goal]).with_time(s))
    new = Frame(np.eye(2), goal.b + SHIFT)
    attractor = tpsim.gmr(tpsim.fit_tp_gmm(encoded, 8, start="time").adapt([new.with_input()]), s)
    means, precisions = np.zeros((len(s), 4)), np.zeros((len(s), 4, 4))
    means[:, :2], precisions[:, :2, :2] = attractor.mean, attractor.precision
    feedback = lqt(means, precisions, integrator(2, DT), EFFORT)
    start = np.r_[encoded[0].data[0, 1:], 0.0, 0.0]
    return attractor, feedback, feedback.rollout(start).states, new.b


def main() -> dict:
    _, feedback, states, goal = retrieve()
    stiffness = np.linalg.det(tpsim.impedance_of(feedback)[0][:-20]) ** 0.5
    return {
        "distance_to_the_new_goal": float(np.linalg.norm(states[-1, :2] - goal)),
        "least_stiffness": float(stiffness.min()),
        "greatest_stiffness": float(stiffness.max()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_path

    attractor, feedback, states, goal = retrieve()
    _, (left, right) = plt.subplots(1, 2)
    draw_path(left, attractor)
    left.plot(*states[:, :2].T, "k", *goal, "o")
    right.plot(np.linalg.det(tpsim.impedance_of(feedback)[0]) ** 0.5)
    right.set_title("stiffness over time")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
