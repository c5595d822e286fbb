"""demo_GMM_MPPCA01: mixture of probabilistic principal component analysers (Eqs 64-68).

Look for: 39 parameters where full covariances have 59: as HDDC, one direction and one noise for
all variables, but found by EM instead of an eigendecomposition.
"""

import numpy as np

from tpsim import MPPCA, fit_gmm
from tpsim.examples import letters

SUBSPACE = 1


def learn():
    """Two letters drawn at once, four variables: MPPCA beside full covariances, same start."""
    both = zip(letters("C", count=5), letters("S", count=5), strict=True)
    data = [np.hstack([c.data, s.data]) for c, s in both]
    models = {
        "MPPCA": fit_gmm(data, 4, covariance=MPPCA(SUBSPACE), start="time"),
        "full": fit_gmm(data, 4, covariance="full", start="time"),
    }
    return data, models


def main() -> dict:
    _, models = learn()
    figures = {}
    for name, gmm in models.items():
        figures[f"free_parameters_{name}"] = gmm.free_parameters
        figures[f"log_likelihood_of_a_sample_{name}"] = float(gmm.history[-1])
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_ellipses

    data, models = learn()
    _, axes = plt.subplots(2, 2)
    for row, (name, gmm) in zip(axes, models.items(), strict=True):
        for axis, dims in zip(row, ([0, 1], [2, 3]), strict=True):
            for x in data:
                axis.plot(*x[:, dims].T, "k", lw=0.6, alpha=0.3)
            draw_ellipses(axis, gmm.gaussians.marginal(dims))
            axis.set_title(name)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
