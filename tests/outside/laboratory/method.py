"""A method for the comparison of Section 8: one Gaussian in every frame at every time."""

import numpy as np

import tpsim


def stepwise(demonstrations):
    """Learn mean and covariance in every frame, time by time; multiply them in new frames."""
    learned = []
    for j in range(len(demonstrations[0].frames)):
        seen = np.array([demonstration.observations[j] for demonstration in demonstrations])
        apart = seen - seen.mean(0)
        covariance = np.einsum("nta,ntb->tab", apart, apart) / len(seen)
        learned.append(tpsim.Gaussian(seen.mean(0), covariance + 1e-6 * np.eye(seen.shape[2])))

    def retrieve(frames):
        pairs = zip(learned, frames, strict=True)
        return tpsim.gaussian_product([g.affine(f.A, f.b) for g, f in pairs if f is not None])

    return retrieve
