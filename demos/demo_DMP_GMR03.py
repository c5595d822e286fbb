"""demo_DMP_GMR03: GMR retrieves the path of the attractor of a movement primitive (Section 5.1).

Look for: the same spring and damper as in demo_DMP_GMR02, tied to a moving point instead of being
pushed; the attractor runs ahead of the path that follows it.
"""

import numpy as np

from tpsim import Motion, attractor_path, decay, fit_gmm, gmr, spring_damper
from tpsim.examples import letters

STIFFNESS, DAMPING, DT = 50.0, 10.0, 0.01


def retrieve():
    """Learn [s, attractor], then let a spring and a damper follow what GMR retrieves."""
    demonstrations = letters("G", samples=201)
    s = decay(201, DT)
    attractors = [attractor_path(Motion.of(d.data, DT), STIFFNESS, DAMPING) for d in demonstrations]
    gmm = fit_gmm([np.c_[s, attractor] for attractor in attractors], 8, start="time")
    attractor = gmr(gmm, s)
    start = np.r_[demonstrations[0].data[0], 0, 0]
    path = spring_damper(attractor.mean, STIFFNESS, DAMPING, DT, start).states[:, :2]
    return demonstrations, attractor, path


def main() -> dict:
    demonstrations, attractor, path = retrieve()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    return {
        "rms_distance_from_the_mean": float(np.sqrt(((path - mean) ** 2).sum(1).mean())),
        "farthest_the_attractor_runs_ahead": float(
            np.linalg.norm(attractor.mean - path, axis=1).max()
        ),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_path

    demonstrations, attractor, path = retrieve()
    axis = plt.figure().gca()
    draw_demonstrations(axis, demonstrations)
    draw_path(axis, attractor)
    axis.plot(*path.T, "k", lw=2)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
