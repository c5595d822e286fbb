"""demo_OC_LQT02: batch LQT of a stepwise reference from a GMM of position and velocity.

Look for: the reference jumps from state to state, the planned path rounds the jumps off
and spends its effort where the Gaussians are tight. More effort cost, rounder corners.
"""

from functools import cache

import numpy as np
from _tracking import Reference

from tpsim import lqt_batch, plot
from tpsim.gallery import present, within

EFFORTS = (1e-5, 1e-3, 1e-1)
REFERENCE = Reference("S", 5)


@cache
def solve():
    """Plan for every effort."""
    steps = REFERENCE.steps
    return {
        effort: lqt_batch(
            steps.mean, steps.precision, REFERENCE.system, effort, REFERENCE.taught[0].data[0]
        )
        for effort in EFFORTS
    }


def main():
    cheap, middle, dear = solve().values()
    largest = [np.abs(plan.controls).max() for plan in (cheap, middle, dear)]
    return {
        "rms_cheap_m": REFERENCE.rms(cheap.states, 0.08, "about the spread of the letters, 0.05"),
        "rms_dear_m": REFERENCE.rms(dear.states, 0.3, "corners are cut, the letter is 2 m high"),
        "acceleration_cheap_over_middle": within(
            largest[0] / largest[1], 1.5, 20, "effort falls as its cost grows"
        ),
        "acceleration_middle_over_dear": within(
            largest[1] / largest[2], 1.5, 20, "effort falls as its cost grows"
        ),
    }


def draw(figure):
    (axis,) = plot.panels(figure, size=(4.2, 4.2))
    REFERENCE.draw(axis, {f"effort {effort:g}": plan.states for effort, plan in solve().items()})
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
