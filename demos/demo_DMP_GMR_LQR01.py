"""demo_DMP_GMR_LQR01: a movement primitive whose spring and damper come from LQR.

Look for: the attractor is retrieved by TP-GMR with its covariance, whose inverse weighs the
tracking; the arm is stiff where the demonstrations agree and soft where they differ.
"""

from functools import cache

import _primitive as shared
import numpy as np

from tpsim import fit_tp_gmm, gmr, impedance_of, integrator, lqt, plot
from tpsim.gallery import present, within

EFFORT = 1e-3


@cache
def retrieve():
    """Learn [s, attractor] in the frame of the goal, move the goal, track the attractor."""
    model = fit_tp_gmm(shared.seen_from_goal(), 8, start="time")
    attractor = gmr(model.adapt([shared.NEW_GOAL.with_input()]), shared.S)
    means, precisions = np.zeros((len(shared.S), 4)), np.zeros((len(shared.S), 4, 4))
    means[:, :2], precisions[:, :2, :2] = attractor.mean, attractor.precision
    feedback = lqt(means, precisions, integrator(2, shared.DT), EFFORT)
    stiffness = np.linalg.det(impedance_of(feedback)[0]) ** 0.5
    start = np.r_[shared.attractors()[0][0], 0.0, 0.0]
    return attractor, stiffness, feedback.rollout(start).states[:, :2]


def main():
    attractor, stiffness, path = retrieve()
    spread = np.linalg.det(attractor.covariance) ** 0.25
    # The horizon ends: what follows is not worth any effort, so the last gains are zero.
    agree = np.corrcoef(np.log(stiffness[:-20]), np.log(spread[:-20]))[0, 1]
    return {
        "distance_to_the_new_goal_m": shared.miss(
            path, shared.NEW_GOAL.b, 0.05, "the demonstrations agree about the goal"
        ),
        "stiffest_over_softest": within(
            np.ptp(np.log10(stiffness[:-20])), 0.3, 3, "powers of ten: it varies with the spread"
        ),
        "correlation_of_stiffness_and_spread": within(
            agree, -1, -0.7, "stiff where the spread is small: precision is its inverse"
        ),
    }


def draw(figure):
    attractor, stiffness, path = retrieve()
    plane, curve = plot.panels(figure, 1, 2, size=(3.5, 3.4), kind=["plane", "curve"])
    shared.draw(plane, path, attractor, shared.NEW_GOAL.b)
    curve.plot(shared.DT * np.arange(len(stiffness))[:-20], stiffness[:-20], color=plot.PALETTE[0])
    curve.set(xlabel="time [s]", ylabel="stiffness [1/s²]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
