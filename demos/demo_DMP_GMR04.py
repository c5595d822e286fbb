"""demo_DMP_GMR04: a movement primitive whose attractor is learned in the frame of the goal.

Look for: the goal is moved and the whole letter goes with it (Section 5.1, one frame).
"""

from functools import cache

import _primitive as shared
import numpy as np

from tpsim import fit_tp_gmm, gmr, plot
from tpsim.gallery import present, within


@cache
def retrieve():
    """Learn [s, attractor] as the goal sees it, then adapt to a goal that was moved."""
    model = fit_tp_gmm(shared.seen_from_goal(), 8, start="time")
    attractor = gmr(model.adapt([shared.NEW_GOAL.with_input()]), shared.S)
    return attractor, shared.follow(attractor.mean)


def main():
    _, path = retrieve()
    moved = path - (shared.NEW_GOAL.b - shared.GOAL)
    half = np.linalg.norm(moved - shared.MEAN, axis=1)[len(path) // 2 :].max()
    return {
        "distance_to_the_new_goal_m": shared.miss(
            path, shared.NEW_GOAL.b, 0.02, "every demonstration ends at its goal: no spread there"
        ),
        "second_half_from_moved_letter_m": within(
            half, 0, 0.3, "the letter has moved with its goal; the start was left where it was"
        ),
    }


def draw(figure):
    attractor, path = retrieve()
    (axis,) = plot.panels(figure, size=(4.2, 4.4))
    shared.draw(axis, path, attractor, shared.NEW_GOAL.b)
    plot.points(axis, shared.GOAL, plot.PALETTE[2], marker="X", label="goal as taught")
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
