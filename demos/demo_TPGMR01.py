"""demo_TPGMR01: a TP-GMM over time, adapted to new frames and retrieved by GMR (Section 5.1).

Look for: the movement leaves the first object and enters the second along their open sides,
wherever they are. Regression in every frame and then the product gives a smoother path than the
product of the mixtures and then regression (Eqs 5-6, 17-20): a component that is long in both
frames may meet far from either centre.
"""

from functools import cache

import _situations as shared
import numpy as np

from tpsim import fit_tp_gmm, tp_gmr
from tpsim.gallery import present, within


@cache
def retrieve():
    """Learn [t, x] in two frames; time is an input that no frame changes (Eq. 20)."""
    timed = [d.with_time() for d in shared.TAUGHT]
    model = fit_tp_gmm(timed, 8, start="time")
    times = timed[0].data[:, :1]
    return [
        shared.adapt(lambda frames, order=order: tp_gmr(model, frames, times, order=order))
        for order in ("regression", "product")
    ]


def length(path):
    return np.linalg.norm(np.diff(path.mean, axis=0), axis=1).sum()


def main():
    regression, product = retrieve()
    far = length(product[-1]) / length(regression[-1])
    return shared.figures(regression) | {
        "length_product_over_regression": within(
            far, 1.0, 2.5, "farthest situation: the product of mixtures makes detours"
        )
    }


def draw(figure):
    shared.draw(figure, *retrieve(), names=("regression, product", "product, regression"))


if __name__ == "__main__":
    present(__file__, main, draw)
