"""demo_DMP_GMR01: a movement primitive with isotropic basis functions (Section 5.1).

Look for: the forcing term, retrieved by GMR with fixed round Gaussians, bends the pull to the goal
into the letter; as its decay s fades, the path comes to rest at the goal.
"""

import numpy as np
from _primitive import S, force_row, forces

from tpsim import GMM, Gaussian
from tpsim.gallery import present


def learn():
    """Place 20 round Gaussians along [s, F], without EM."""
    encoded = np.mean([np.c_[S, force] for force in forces()], axis=0)
    centres = np.array([part.mean(0) for part in np.array_split(encoded, 20)])
    return GMM(np.full(20, 0.05), Gaussian(centres, np.tile(1e-3 * np.eye(3), (20, 1, 1))))


main, draw = force_row(learn, 0.15, "20 round Gaussians: coarse")

if __name__ == "__main__":
    present(__file__, main, draw)
