"""demo_DMP_GMR03: GMR retrieves the path of the attractor of a movement primitive (Section 5.1).

Look for: the same spring and damper as in demo_DMP_GMR02, tied to a moving point instead of being
pushed; the attractor runs ahead of the path that follows it, farthest where the pen is fast.
"""

from functools import cache

import _primitive as shared
import numpy as np

from tpsim import fit_gmm, gmr, plot
from tpsim.gallery import present, within


@cache
def retrieve():
    """Learn [s, attractor], then let a spring and a damper follow what GMR retrieves."""
    gmm = fit_gmm([np.c_[shared.S, path] for path in shared.attractors()], 8, start="time")
    attractor = gmr(gmm, shared.S)
    return attractor, shared.follow(attractor.mean)


def ahead():
    attractor, path = retrieve()
    return np.linalg.norm(attractor.mean - path, axis=1)


def main():
    _, path = retrieve()
    speed = np.linalg.norm(np.gradient(shared.MEAN, shared.DT, axis=0), axis=1).max()
    lag = speed * shared.DAMPING / shared.STIFFNESS
    return {
        "rms_from_the_mean_letter_m": shared.rms_from_mean(
            path, 0.1, "the spread of the letters themselves is 0.05"
        ),
        "farthest_ahead_m": within(
            ahead().max(), 0.5 * lag, 1.5 * lag, "about speed times damping over stiffness"
        ),
    }


def draw(figure):
    attractor, path = retrieve()
    plane, curve = plot.panels(figure, 1, 2, kind=["plane", "curve"])
    shared.draw(plane, path, attractor, shared.MEAN[-1])
    curve.plot(shared.DT * np.arange(len(path)), ahead(), color=plot.PALETTE[1])
    curve.set(xlabel="time [s]", ylabel="lead of the attractor [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
