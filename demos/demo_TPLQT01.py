"""demo_TPLQT01: LQT of a stepwise reference seen in two coordinate systems (TP-LQT, Eq. 38).

Look for: the path leaves the first U and enters the second along their open sides, in
situations that were not taught; tracking in both frames at once is tracking their product. The
reference has three steps, so that in the farthest situation the turn into the U comes late.
"""

from functools import cache

import _situations as shared
import numpy as np

from tpsim import Gaussian, fit_tp_gmm, integrator, lqt_batch
from tpsim.gallery import present, within

COMPONENTS, EFFORT = 3, 1e-4


@cache
def solve():
    """Plan (T, 2) with its covariance, in every situation."""
    taught = [demonstration.with_derivatives(1) for demonstration in shared.TAUGHT]
    model = fit_tp_gmm(taught, COMPONENTS, start="time")
    states = model.responsibilities(taught[:1]).argmax(axis=1)
    system = integrator(2, taught[0].time[1])

    def plan(frames):
        start = np.r_[frames[0].b, 0.0, 0.0]
        reference = model.adapt([f.with_derivatives(1) for f in frames]).gaussians[states]
        found = lqt_batch(
            reference.mean, reference.precision, system, EFFORT, start, covariance=True
        )
        return Gaussian(found.states, found.covariance).marginal([0, 1])

    return shared.adapt(plan)


def main():
    spread = [np.sqrt(np.linalg.eigvalsh(path.covariance).max(-1)) for path in solve()]
    thinner = min(s.max() / s[-1] for s in spread)
    return shared.figures(solve(), end=0.05, angle=75) | {
        "least_ratio_of_spreads_middle_to_end": within(
            thinner, 1.5, 100, "minimal intervention: the middle is left free, the end is not"
        )
    }


def draw(figure):
    shared.draw(figure, solve())


if __name__ == "__main__":
    present(__file__, main, draw)
