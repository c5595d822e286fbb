"""Speeds of learning: EM beside scikit-learn's, adaptation, growth with the data."""

import warnings
from collections.abc import Callable
from functools import partial

import numpy as np

from tpsim.bench import poses
from tpsim.bench.timing import median_time
from tpsim.frame import Frame
from tpsim.learning.gmm import fit_gmm
from tpsim.learning.subspace import MFA
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.world.threads import one_thread

COMPONENTS = 5


def run(quick: bool = False) -> dict[str, float]:
    """Median times of fits and adaptation.

    N = 2000 samples, P = 3 frames of D = 4, K = 5; scikit-learn's GaussianMixture gets the same
    samples with the frames side by side (D = 12), full covariances, the same K and start.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, and growth from 2e4 samples instead of 2e5.

    Returns
    -------
    dict
        Times in ms or us as the names say. ``*_factor`` is the cost of many samples over that of
        2000, divided by the ratio of their numbers (linear: 1). scikit-learn's entries are
        missing where it is not installed.
    """
    with one_thread():
        return _run(quick, 3 if quick else 15)


def _run(quick: bool, repetitions: int) -> dict[str, float]:
    views = movements(2000)
    figures = _fits(views, repetitions) | _beside_scikit_learn(views, repetitions)
    if "sklearn_iteration_ms" in figures:
        ratio = figures["sklearn_iteration_ms"] / figures["em_iteration_ms"]
        figures["sklearn_over_tpsim_iteration"] = ratio
    figures |= _adaptation(views, repetitions) | poses.learning(quick)
    return figures | _wide(repetitions) | _growth(quick)


def movements(count: int) -> list[np.ndarray]:
    """Time and three smooth noisy variables, seen from three frames: (N, 4) each."""
    rng, time = np.random.default_rng(0), np.linspace(0.0, 2.0, count)
    rates = np.arange(1, 4)
    return [
        np.column_stack(
            [time, np.sin(rates * frame * time[:, None]) + 0.05 * rng.standard_normal((count, 3))]
        )
        for frame in rates
    ]


def _per_iteration(fit: Callable[[int], object], few: int, many: int, repetitions: int) -> float:
    """Seconds of one iteration: what ``many`` cost more than ``few``."""
    long, short = (median_time(partial(fit, n), repetitions) for n in (many, few))
    return (long - short) / (many - few)


def _fits(views: list[np.ndarray], repetitions: int) -> dict[str, float]:
    def iterate(n: int) -> None:
        fit_tp_gmm(views, COMPONENTS, start="time", tolerance=-np.inf, max_iterations=n)

    whole = partial(fit_tp_gmm, views, COMPONENTS, start="time")
    return {
        "fit_ms": 1e3 * median_time(whole, repetitions),
        "fit_iterations": len(whole().history) - 1,
        "em_iteration_ms": 1e3 * _per_iteration(iterate, 5, 45, repetitions),
    }


def _beside_scikit_learn(views: list[np.ndarray], repetitions: int) -> dict[str, float]:
    try:
        from sklearn.mixture import GaussianMixture
    except ImportError:
        return {}
    stacked = np.hstack(views)
    begin = fit_gmm(stacked, COMPONENTS, start="time", max_iterations=0)

    def fit(n: int, tolerance: float = 0.0) -> None:
        GaussianMixture(
            COMPONENTS,
            tol=tolerance,
            max_iter=n,
            weights_init=begin.priors,
            means_init=begin.gaussians.mean,
            precisions_init=begin.gaussians.precision,
        ).fit(stacked)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fixed number of iterations does not converge
        return {
            "sklearn_fit_ms": 1e3 * median_time(partial(fit, 100, 1e-5), repetitions),
            "sklearn_iteration_ms": 1e3 * _per_iteration(fit, 5, 25, repetitions),
        }


def _adaptation(views: list[np.ndarray], repetitions: int) -> dict[str, float]:
    model, rng = fit_tp_gmm(views, COMPONENTS, start="time"), np.random.default_rng(0)
    rotations = np.linalg.qr(rng.standard_normal((3, 3, 3)))[0]
    offsets = rng.standard_normal((3, 3))
    frames = [Frame(A, b).with_input() for A, b in zip(rotations, offsets, strict=True)]
    adapt = partial(model.adapt, frames)
    return {"adapt_us": 1e6 * median_time(adapt, 100 * repetitions)}


def _wide(repetitions: int) -> dict[str, float]:
    """Fig. 6: factor analysers with D = 94, K = 12, d = 2, N = 2000."""
    rng, time = np.random.default_rng(0), np.linspace(0.0, 6.0, 2000)
    latent = np.sin(time[:, None] * np.arange(1, 5))
    data = latent @ rng.standard_normal((4, 94)) + 0.1 * rng.standard_normal((2000, 94))

    def iterate(n: int) -> None:
        fit_gmm(data, 12, covariance=MFA(2), start="time", tolerance=-np.inf, max_iterations=n)

    return {"mfa_94_iteration_ms": 1e3 * _per_iteration(iterate, 1, 6, min(repetitions, 5))}


def _growth(quick: bool) -> dict[str, float]:
    many = 20_000 if quick else 200_000

    def seconds(count: int, repetitions: int) -> float:
        views = movements(count)
        fit = partial(
            fit_tp_gmm, views, COMPONENTS, start="time", tolerance=-np.inf, max_iterations=30
        )
        return median_time(fit, repetitions)

    factor = seconds(many, 1 if quick else 3) / seconds(2000, 9) / (many / 2000)
    return {f"growth_{many}_factor": factor}
