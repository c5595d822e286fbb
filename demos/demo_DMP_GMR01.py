"""demo_DMP_GMR01: a movement primitive with isotropic basis functions (Section 5.1).

Look for: the forcing term, retrieved by GMR with fixed round Gaussians, bends the pull to the goal
into the letter; as its decay s fades, the path comes to rest at the goal.
"""

from functools import cache

import _primitive as shared
import numpy as np

from tpsim import GMM, Gaussian, forced_attractor, gmr, plot
from tpsim.gallery import present


@cache
def retrieve():
    """Place 20 round Gaussians along [s, F], without EM."""
    encoded = np.mean([np.c_[shared.S, force] for force in shared.forces()], axis=0)
    centres = np.array([part.mean(0) for part in np.array_split(encoded, 20)])
    gmm = GMM(np.full(20, 0.05), Gaussian(centres, np.tile(1e-3 * np.eye(3), (20, 1, 1))))
    forcing = gmr(gmm, shared.S)
    attractor = forced_attractor(shared.GOAL, forcing.mean, shared.S, shared.STIFFNESS)
    return forcing, attractor, shared.follow(attractor)


def main():
    _, _, path = retrieve()
    return {
        "distance_to_goal_m": shared.miss(path, shared.GOAL, 0.1, "the force has faded to 13 %"),
        "rms_from_the_mean_letter_m": shared.rms_from_mean(
            path, 0.15, "20 round Gaussians: coarse"
        ),
    }


def draw(figure):
    forcing, attractor, path = retrieve()
    plane, curve = plot.panels(figure, 1, 2)
    known = Gaussian(attractor, np.zeros((len(attractor), 2, 2)))
    shared.draw(plane, path, known, shared.GOAL)
    shared.draw_forces(curve, forcing)
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
