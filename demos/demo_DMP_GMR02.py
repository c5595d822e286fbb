"""demo_DMP_GMR02: a movement primitive with full covariances learned by EM (Section 5.1).

Look for: few Gaussians suffice for the forcing term once EM shapes them: compare demo_DMP_GMR01,
which needs many round ones.
"""

import numpy as np
from _primitive import S, force_row, forces

from tpsim import fit_gmm
from tpsim.gallery import present


def learn():
    """Learn [s, F] of every demonstration."""
    return fit_gmm([np.c_[S, force] for force in forces()], 8, start="time")


main, draw = force_row(learn, 0.1, "nearer than 20 round ones: the spread of the letters is 0.05")

if __name__ == "__main__":
    present(__file__, main, draw)
