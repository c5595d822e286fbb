"""demo_DMP_GMR04: a movement primitive whose attractor is learned in the frame of the goal.

Look for: the goal is moved and the whole letter goes with it (Section 5.1, one frame).
"""

import numpy as np

import tpsim
from tpsim import Demonstration, Frame, Motion
from tpsim.examples import letters

STIFFNESS, DAMPING, DT = 50.0, 10.0, 0.01
SHIFT = np.array([0.0, 1.5])


def retrieve():
    """Learn [s, attractor] as the goal sees it, then adapt to a goal that was moved."""
    s, goals, encoded = tpsim.decay(201, DT), [], []
    for d in letters("G", samples=201):
        attractor = tpsim.attractor_path(Motion.of(d.data, DT), STIFFNESS, DAMPING)
        goals.append(Frame(np.eye(2), d.data[-1]))
        encoded.append(Demonstration(d.time, attractor, goals[-1:]).with_time(s))
    model = tpsim.fit_tp_gmm(encoded, 8, start="time")
    new = Frame(np.eye(2), goals[-1].b + SHIFT)
    attractor = tpsim.gmr(model.adapt([new.with_input()]), s)
    start = np.r_[encoded[0].data[0, 1:], 0, 0]
    path = tpsim.spring_damper(attractor.mean, STIFFNESS, DAMPING, DT, start).states[:, :2]
    return attractor, path, goals[-1].b, new.b


def main() -> dict:
    _, path, taught, new = retrieve()
    return {
        "distance_to_the_new_goal": float(np.linalg.norm(path[-1] - new)),
        "distance_to_the_taught_goal": float(np.linalg.norm(path[-1] - taught)),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_path

    attractor, path, taught, new = retrieve()
    axis = plt.figure().gca()
    draw_demonstrations(axis, letters("G"))
    draw_path(axis, attractor)
    axis.plot(*path.T, "k", lw=2)
    axis.plot(*np.c_[taught, new], "o--")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
