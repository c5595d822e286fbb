"""demo_TPproMP01: probabilistic movement primitives seen from several frames (Section 5.2).

Look for: a few basis functions carry the whole movement; the product over frames is taken once,
on their weights, and gives correlations between all time steps.
"""

from functools import cache

import _situations as shared

from tpsim import fit_tp_promp
from tpsim.gallery import present


@cache
def retrieve():
    """Fit the weights of 12 basis functions in each frame, then multiply the Gaussians."""
    model = fit_tp_promp(shared.TAUGHT, 12, weight_ridge=1e-3)
    return shared.adapt(lambda frames: model.adapt(frames).distribution(200).marginal())


main, draw = shared.row(retrieve)

if __name__ == "__main__":
    present(__file__, main, draw)
