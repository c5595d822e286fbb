"""demo_GMM01: a Gaussian mixture fitted to a letter by EM.

Look for: the components line up along the stroke, and the likelihood rises at every iteration
(Eqs 49-52).
"""

import numpy as np

from tpsim import fit_gmm
from tpsim.examples import letters


def learn():
    """Five components on positions alone."""
    demonstrations = letters("G", count=5)
    return demonstrations, fit_gmm([d.data for d in demonstrations], 5, start="kmeans")


def main() -> dict:
    _, gmm = learn()
    return {
        "components": gmm.components,
        "free_parameters": gmm.free_parameters,
        "iterations": len(gmm.history) - 1,
        "log_likelihood_of_a_sample_at_the_start": float(gmm.history[0]),
        "log_likelihood_of_a_sample": float(gmm.history[-1]),
        "smallest_gain_of_an_iteration": float(np.diff(gmm.history).min()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_ellipses

    demonstrations, gmm = learn()
    axis = plt.figure().gca()
    draw_demonstrations(axis, demonstrations)
    draw_ellipses(axis, gmm.gaussians)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
