"""figure05: factor analysis between diagonal and full covariances (Section 4.2, Fig. 5).

Look for: every factor that is added brings the covariance nearer to the full one (Eq. 11), for a
few parameters each; the diagonal is right at once, since each variable has a noise of its own.
"""

from functools import cache

import numpy as np

from tpsim import MFA, fit_gmm, plot
from tpsim.gallery import present, within

D, FACTORS = 10, (1, 2, 3)


@cache
def learn():
    """Ten variables driven by three factors; one Gaussian with ever richer covariances."""
    rng = np.random.default_rng(5)
    factors = rng.standard_normal((400, 3)) * [1.0, 0.8, 0.6]
    noise = rng.uniform(0.3, 0.6, D) * rng.standard_normal((400, D))
    data = factors @ rng.standard_normal((3, D)) + noise
    kinds = {"diagonal": "diagonal"}
    kinds |= {f"{d} factor{'s' if d > 1 else ''}": MFA(d) for d in FACTORS} | {"full": "full"}
    return {
        name: fit_gmm(data, 1, covariance=kind, start="time", tolerance=1e-6, max_iterations=300)
        for name, kind in kinds.items()
    }


def main():
    models = learn()
    S = {name: gmm.gaussians.covariance[0] for name, gmm in models.items()}
    scale = np.linalg.norm(S["full"])
    gaps = [np.linalg.norm(covariance - S["full"]) / scale for covariance in S.values()]
    sizes = [gmm.free_parameters for gmm in models.values()]
    diagonal = max(np.abs(np.diag(c) / np.diag(S["full"]) - 1).max() for c in S.values())
    likelihoods = [gmm.history[-1] for gmm in models.values()]
    return {
        "gap_diagonal": within(gaps[0], 0.5, 1, "share of the full covariance off the diagonal"),
        "gap_three_factors": within(gaps[3], 0, 0.05, "the data have three factors"),
        "least_gain_of_a_factor": within(
            np.diff(likelihoods)[:3].min(), 0.1, np.inf, "nats per sample"
        ),
        "largest_error_of_a_variance": within(diagonal, 0, 0.05, "each variable has its own noise"),
        "parameters_diagonal": within(sizes[0], 2 * D, 2 * D, "means and variances"),
        "parameters_full": within(sizes[-1], 65, 65, "10 + 55"),
    }


def draw(figure):
    axes = plot.panels(figure, 1, 5, size=(1.7, 2.0))
    for axis, (name, gmm) in zip(axes, learn().items(), strict=True):
        plot.matrix(axis, gmm.gaussians.covariance[0])
        plot.title(axis, f"{name}\n{gmm.free_parameters} parameters")


if __name__ == "__main__":
    present(__file__, main, draw)
