"""demo_DMP_GMR01: a movement primitive with isotropic basis functions (Section 5.1).

Look for: the forcing term, retrieved by GMR with fixed round Gaussians, bends the pull to the goal
into the letter; as its decay s fades, the path comes to rest at the goal.
"""

import numpy as np

from tpsim import GMM, Gaussian, Motion, decay, forced_attractor, forcing_term, gmr, spring_damper
from tpsim.examples import letters

STIFFNESS, DAMPING, DT = 50.0, 10.0, 0.01


def retrieve():
    """Place round Gaussians along [s, F], without EM."""
    demonstrations = letters("G", samples=201)
    s, goal = decay(201, DT), demonstrations[0].data[-1]
    forces = [
        forcing_term(Motion.of(d.data, DT), goal, s, STIFFNESS, DAMPING) for d in demonstrations
    ]
    encoded = np.array([np.c_[s, force] for force in forces]).mean(0)
    centres = np.array([part.mean(0) for part in np.array_split(encoded, 20)])
    gmm = GMM(np.full(20, 0.05), Gaussian(centres, np.tile(1e-3 * np.eye(3), (20, 1, 1))))
    attractor = forced_attractor(goal, gmr(gmm, s).mean, s, STIFFNESS)
    start = np.r_[demonstrations[0].data[0], 0, 0]
    path = spring_damper(attractor, STIFFNESS, DAMPING, DT, start).states[:, :2]
    return demonstrations, attractor, path, goal


def main() -> dict:
    demonstrations, _, path, goal = retrieve()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    return {
        "distance_to_goal": float(np.linalg.norm(path[-1] - goal)),
        "rms_distance_from_the_mean": float(np.sqrt(((path - mean) ** 2).sum(1).mean())),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    demonstrations, attractor, path, goal = retrieve()
    axis = plt.figure().gca()
    draw_demonstrations(axis, demonstrations)
    axis.plot(*attractor.T, "--", lw=0.8)
    axis.plot(*path.T, lw=2)
    axis.plot(*goal, "o")
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
