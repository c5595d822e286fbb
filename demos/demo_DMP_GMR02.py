"""demo_DMP_GMR02: a movement primitive with full covariances learned by EM (Section 5.1).

Look for: few Gaussians suffice for the forcing term once EM shapes them: compare demo_DMP_GMR01,
which needs many round ones.
"""

import numpy as np

from tpsim import Motion, decay, fit_gmm, forced_attractor, forcing_term, gmr, spring_damper
from tpsim.examples import letters

STIFFNESS, DAMPING, DT = 50.0, 10.0, 0.01


def retrieve():
    """Learn [s, F] of every demonstration, then retrieve F given s."""
    demonstrations = letters("G", samples=201)
    s, goal = decay(201, DT), demonstrations[0].data[-1]
    forces = [
        forcing_term(Motion.of(d.data, DT), goal, s, STIFFNESS, DAMPING) for d in demonstrations
    ]
    gmm = fit_gmm([np.c_[s, force] for force in forces], 8, start="time")
    forcing = gmr(gmm, s)
    attractor = forced_attractor(goal, forcing.mean, s, STIFFNESS)
    start = np.r_[demonstrations[0].data[0], 0, 0]
    path = spring_damper(attractor, STIFFNESS, DAMPING, DT, start).states[:, :2]
    return demonstrations, forcing, path, goal


def main() -> dict:
    demonstrations, _, path, goal = retrieve()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    return {
        "distance_to_goal": float(np.linalg.norm(path[-1] - goal)),
        "rms_distance_from_the_mean": float(np.sqrt(((path - mean) ** 2).sum(1).mean())),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_path

    demonstrations, forcing, path, goal = retrieve()
    left, right = plt.figure().subplots(1, 2)
    draw_path(left, forcing)
    left.set_title("forcing term")
    draw_demonstrations(right, demonstrations)
    right.plot(*path.T, lw=2)
    right.plot(*goal, "o")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
