"""demo_TPtrajDistrib01: whole trajectories as one Gaussian, by eigencomponents (Section 5.2).

Look for: three modes per frame hold what varies between demonstrations; their product over frames
stays low rank, so its cost grows with the length of the movement only.
"""

from functools import cache

import _situations as shared

from tpsim import fit_tp_trajectory_distribution
from tpsim.gallery import present


@cache
def retrieve():
    """Keep 3 eigencomponents of the trajectories in each frame, then multiply."""
    model = fit_tp_trajectory_distribution(shared.TAUGHT, 3, noise=1e-2)
    return shared.adapt(lambda frames: model.adapt(frames).marginal())


main, draw = shared.row(retrieve)

if __name__ == "__main__":
    present(__file__, main, draw)
