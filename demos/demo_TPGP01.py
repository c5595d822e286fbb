"""demo_TPGP01: a Gaussian process in every frame, fused over frames (Section 8, Fig. 13).

Look for: data-driven retrieval adapts to the frames as a mixture does, with the spread of the
data around each process as its certainty. It keeps all its data, and is slower for it.
"""

from functools import cache

import _situations as shared
import numpy as np

from tpsim import SquaredExponential, fit_gp, fuse_frames
from tpsim.gallery import present


@cache
def retrieve():
    """Regress over time in each frame, then take the product at every step."""
    times = shared.TAUGHT[0].time[::2]
    time = np.concatenate([d.time[::2] for d in shared.TAUGHT])
    views = zip(*(d.observations for d in shared.TAUGHT), strict=True)
    kernel = SquaredExponential(variance=1.0, length=0.2, noise=1e-2)
    local = [
        fit_gp(time, np.concatenate([seen[::2] for seen in view]), kernel).spread(times)
        for view in views
    ]
    return shared.adapt(lambda frames: fuse_frames(local, frames))


main, draw = shared.row(retrieve)

if __name__ == "__main__":
    present(__file__, main, draw)
