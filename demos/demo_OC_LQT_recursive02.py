"""demo_OC_LQT_recursive02: recursive LQT of a GMM of position and velocity, against batch LQT.

Look for: dynamic programming and one banded least squares problem give the same path, to
rounding; the recursion also answers from any other start.
"""

from functools import cache

import numpy as np
from _tracking import Reference

from tpsim import lqt, lqt_batch, plot
from tpsim.gallery import present, within

EFFORT = 1e-5
REFERENCE = Reference("S", 5)


@cache
def solve():
    """Batch plan, and roll-outs of the feedback from three starts."""
    steps, system, start = REFERENCE.steps, REFERENCE.system, REFERENCE.taught[0].data[0]
    feedback = lqt(steps.mean, steps.precision, system, EFFORT)
    batch = lqt_batch(steps.mean, steps.precision, system, EFFORT, start)
    aside = np.zeros((3, 4))
    aside[1:, :2] = [0.3, 0.0], [0.0, -0.3]
    return batch.states, [feedback.rollout(start + offset).states for offset in aside]


def main():
    batch, rollouts = solve()
    return {
        "batch_minus_recursive_m": within(
            np.abs(batch - rollouts[0]).max(), 0, 1e-9, "one optimum, found in two ways"
        ),
        "ends_apart_m": within(
            np.ptp([path[-1, :2] for path in rollouts], axis=0).max(),
            0,
            0.01,
            "the feedback leads every start to the same end",
        ),
    }


def draw(figure):
    batch, rollouts = solve()
    (axis,) = plot.panels(figure, size=(4.2, 4.2))
    names = ("recursive", "another start", "a third start")
    REFERENCE.draw(axis, dict(zip(names, rollouts, strict=True)))
    axis.plot(*batch[:, :2].T, ":", color=plot.INK, lw=2.4, label="batch", zorder=4)
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
