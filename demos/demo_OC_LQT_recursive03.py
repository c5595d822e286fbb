"""demo_OC_LQT_recursive03: recursive LQT of a GMM of positions alone.

Look for: velocities have no precision (the weights are singular), so the controller finds
them; the path is smooth although the reference steps from mean to mean.
"""

from functools import cache

import numpy as np
from _tracking import Reference

from tpsim import lqt, plot
from tpsim.gallery import present, within

EFFORT = 1e-3
REFERENCE = Reference("C", 8, derivatives=0)


@cache
def solve():
    """Plan (T, 4) for the stepwise reference."""
    steps, T = REFERENCE.steps, len(REFERENCE.states)
    means, precisions = np.zeros((T, 4)), np.zeros((T, 4, 4))
    means[:, :2], precisions[:, :2, :2] = steps.mean, steps.precision
    return lqt(means, precisions, REFERENCE.system, EFFORT).rollout(REFERENCE.start).states


def main():
    jump, step = (
        np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1).max()
        for path in (REFERENCE.steps.mean, solve())
    )
    return {
        "rms_to_demonstration_m": REFERENCE.rms(solve(), 0.12, "the means are 0.3 apart"),
        "largest_step_over_jump": within(step / jump, 0, 0.2, "smooth, where the reference jumps"),
    }


def draw(figure):
    (axis,) = plot.panels(figure, size=(3.8, 4.4))
    REFERENCE.draw(axis, {"path": solve()})
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
