"""demo_GMM01: a Gaussian mixture fitted to a letter by EM.

Look for: the components line up along the stroke, and the likelihood rises at every iteration
(Eqs 49-52).
"""

from functools import cache

import numpy as np

from tpsim import fit_gmm, plot
from tpsim.examples import letters
from tpsim.gallery import present, within


@cache
def learn():
    """Five components on positions alone."""
    demonstrations = letters("G", count=5)
    return demonstrations, fit_gmm([d.data for d in demonstrations], 5, start="kmeans")


def main():
    _, gmm = learn()
    return {
        "free_parameters": within(gmm.free_parameters, 29, 29, "5 (2 + 3) + 4"),
        "log_likelihood_gained": within(
            gmm.history[-1] - gmm.history[0], 0.1, 1.0, "EM improves on k-means"
        ),
        "smallest_gain_of_an_iteration": within(
            np.diff(gmm.history).min(), -1e-12, np.inf, "EM never lowers the likelihood"
        ),
        "least_prior": within(
            gmm.priors.min(), 0.05, 0.2, "no component is empty; the average is 1/5"
        ),
    }


def draw(figure):
    demonstrations, gmm = learn()
    plane, curve = plot.panels(figure, 1, 2, kind=["plane", "curve"])
    plot.demonstrations(plane, demonstrations, label="demonstrations")
    plot.ellipses(plane, gmm.gaussians, label="components")
    plane.set(xlabel="x [m]", ylabel="y [m]")
    curve.plot(gmm.history, color=plot.PALETTE[1], lw=1.8)
    curve.set(xlabel="iteration", ylabel="log-likelihood of a sample")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
