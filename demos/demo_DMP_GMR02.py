"""demo_DMP_GMR02: a movement primitive with full covariances learned by EM (Section 5.1).

Look for: few Gaussians suffice for the forcing term once EM shapes them: compare demo_DMP_GMR01,
which needs many round ones.
"""

from functools import cache

import _primitive as shared
import numpy as np

from tpsim import fit_gmm, forced_attractor, gmr, plot
from tpsim.gallery import present


@cache
def retrieve():
    """Learn [s, F] of every demonstration, then retrieve F given s."""
    gmm = fit_gmm([np.c_[shared.S, force] for force in shared.forces()], 8, start="time")
    forcing = gmr(gmm, shared.S)
    attractor = forced_attractor(shared.GOAL, forcing.mean, shared.S, shared.STIFFNESS)
    return forcing, attractor, shared.follow(attractor)


def main():
    _, _, path = retrieve()
    return {
        "distance_to_goal_m": shared.miss(path, shared.GOAL, 0.1, "the force has faded to 13 %"),
        "rms_from_the_mean_letter_m": shared.rms_from_mean(
            path, 0.1, "nearer than 20 round ones: the spread of the letters is 0.05"
        ),
    }


def draw(figure):
    forcing, attractor, path = retrieve()
    plane, curve = plot.panels(figure, 1, 2)
    # The force is s F, so its spread fades with s; stiffness turns it into a displacement.
    scale = (shared.S / shared.STIFFNESS)[:, None, None]
    shared.draw(plane, path, type(forcing)(attractor, scale**2 * forcing.covariance), shared.GOAL)
    shared.draw_forces(curve, forcing)
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
