"""Which model: how many components, which structure, by information criteria or by DP-means."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Part
from tpsim.border import checked, read
from tpsim.checks import choice, entries, is_table, matrix, number, whole
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.learning.em import maximise, regularisation
from tpsim.learning.fit import seen_as_data, seen_by_frames
from tpsim.learning.gmm import GMM
from tpsim.learning.start import kmeans, standardised
from tpsim.learning.statistics import Samples
from tpsim.learning.subspace import Full, Structure, structure_of
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm


def bic(model, *data) -> float:
    """Bayesian information criterion, [Schwarz 1978]: p log N - 2 log L; lower is better.

    Parameters
    ----------
    model : GMM, TPGMM or PGMM
        Anything with ``log_likelihood`` and ``free_parameters``.
    *data
        What ``model.log_likelihood`` takes.
    """
    log_likelihood = _log_likelihood(model, data)
    return _bic(log_likelihood.sum(), model.free_parameters, log_likelihood.size)


def aic(model, *data) -> float:
    """Akaike information criterion, 2 p - 2 log L; lower is better. Arguments as in :func:`bic`."""
    log_likelihood = _log_likelihood(model, data)
    return _aic(log_likelihood.sum(), model.free_parameters, log_likelihood.size)


def _log_likelihood(model, data: tuple) -> np.ndarray:
    if not hasattr(model, "log_likelihood") or not hasattr(model, "free_parameters"):
        raise ArgumentError(f"model is a {type(model).__name__}; give a GMM, TPGMM or PGMM")
    found = np.asarray(model.log_likelihood(*data))
    if found.size == 0:
        raise ArgumentError("no samples were given; a criterion needs at least one")
    return found


def _bic(log_likelihood: float, parameters: int, samples: int) -> float:
    return float(parameters * np.log(samples) - 2 * log_likelihood)


def _aic(log_likelihood: float, parameters: int, samples: int) -> float:
    return float(2 * parameters - 2 * log_likelihood)


_CRITERIA = {"bic": _bic, "aic": _aic}


@dataclass(frozen=True)
class Candidate:
    """One model that was tried.

    Attributes
    ----------
    components : int
        Number of components K.
    covariance : str or structure
        Covariance structure, with its subspace dimension d.
    free_parameters : int
        Number of free parameters p.
    log_likelihood : float
        Of all samples [nats].
    score : float
        The criterion; lower is better.
    """

    components: int
    covariance: str | Structure
    free_parameters: int
    log_likelihood: float
    score: float


@dataclass(frozen=True, eq=False)
class Selection:
    """The best model, and all that were tried, the best first."""

    model: GMM | TPGMM
    candidates: tuple[Candidate, ...]

    def __post_init__(self) -> None:
        checked(self)

    def __str__(self) -> str:
        """Table of the candidates."""
        rows = [f"{'K':>3}  {'covariance':<20} {'parameters':>10} {'log-lik.':>12} {'score':>12}"]
        for c in self.candidates:
            rows.append(
                f"{c.components:>3}  {c.covariance!s:<20} {c.free_parameters:>10} "
                f"{c.log_likelihood:>12.1f} {c.score:>12.1f}"
            )
        return "\n".join(rows)


def select_model(
    data,
    components: Iterable[int] = range(1, 11),
    covariances: Sequence[str | Structure] = ("full",),
    *,
    criterion: str = "bic",
    fit: Callable[..., GMM | TPGMM] = fit_tp_gmm,
    **options,
) -> Selection:
    """Fit every combination of K and covariance structure and keep the best (Section 9).

    Parameters
    ----------
    data
        What ``fit`` takes: demonstrations, or views per frame.
    components : iterable of int
        Numbers of components K to try.
    covariances : sequence of str or structure
        Structures to try, such as ``("full", MFA(1), MFA(2))`` to choose d.
    criterion : "bic" or "aic"
        What is minimised.
    fit : function
        ``fit_tp_gmm`` or ``fit_gmm``; called as ``fit(data, K, covariance=..., **options)``.
    **options
        Passed on to ``fit``.

    Returns
    -------
    Selection

    Raises
    ------
    ArgumentError
        Nothing to try, an unknown criterion, or what ``fit`` refuses.

    Notes
    -----
    Both criteria count samples as independent. Those of a movement are not: sampled twice as
    densely it appears to hold twice as much information, and K comes out larger. Compare at the
    sampling rate at which the model will be used.
    """
    choice("criterion", criterion, _CRITERIA)
    read("fit", fit, Callable)
    counts = [components] if isinstance(components, int) else entries("components", components)
    single = isinstance(covariances, str | Part)
    structures = [covariances] if single else entries("covariances", covariances)
    if not counts or not structures:
        raise ArgumentError("nothing to try; give at least one K and one covariance structure")
    tried = []
    for one in structures:
        covariance = one if isinstance(one, str) else structure_of(one)
        for count in counts:
            K = whole("components", count, least=1)
            model = fit(data, K, covariance=covariance, **options)
            total = float(model.history[-1] * model.samples)
            score = _CRITERIA[criterion](total, model.free_parameters, model.samples)
            tried.append((Candidate(K, covariance, model.free_parameters, total, score), model))
    tried.sort(key=lambda pair: pair[0].score)
    return Selection(tried[0][1], tuple(candidate for candidate, _ in tried))


def dp_means(points: ArrayLike, radius: float = 1.0) -> np.ndarray:
    """Cluster with as many clusters as the data need: DP-means, [Kulis and Jordan 2012] ([52]).

    The small-variance limit of a Dirichlet process mixture: k-means that pays radius^2 for each
    cluster. A sample farther than ``radius`` from all centres founds a new one, the farthest
    first, so that the order of the samples does not matter.

    Parameters
    ----------
    points : (N, D)
        Samples.
    radius : float
        Root mean square deviation over the columns, each divided by its standard deviation.

    Returns
    -------
    (N,) int array
        Labels 0 ... K - 1.

    Raises
    ------
    ArgumentError
        Points that are not a finite (N, D) array, or a radius that is not positive.
    """
    radius = number("radius", radius, above=0)
    points = standardised([matrix("points", points)])
    centres = points.mean(0, keepdims=True)
    while True:
        labels, centres = kmeans(points, centres)
        deviation = np.sqrt(((points - centres[labels]) ** 2).mean(1))
        if deviation.max() <= radius:
            return labels
        centres = np.vstack([centres, points[deviation.argmax()]])


def dp_means_start(
    data: ArrayLike | Sequence[Demonstration] | Sequence[ArrayLike],
    radius: float = 1.0,
    *,
    ridge: float | None = None,
) -> GMM | TPGMM:
    """Mixture with the number of components that DP-means finds, for EM to begin with.

    Parameters
    ----------
    data : (N, D) array for a GMM; demonstrations or P arrays (N, d_j) for a TP-GMM
        In a TP-GMM the views of all frames are clustered together.
    radius : float
        As in :func:`dp_means`.
    ridge : float, optional
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.

    Returns
    -------
    GMM or TPGMM
        As in ``start = dp_means_start(demos); fit_tp_gmm(demos, start.components, start=start)``.
    """
    plain = is_table("data", data)
    views = (seen_as_data(data) if plain else seen_by_frames(data)).views
    labels = dp_means(np.hstack(views), radius)
    samples = Samples(views)
    one_hot = (labels[:, None] == np.arange(labels.max() + 1)).astype(float)
    parts = samples.moments(one_hot)
    mixture = maximise(parts, None, Full(), regularisation(samples, ridge, parts))
    frames = mixture.frames(samples)
    return GMM(mixture.priors, frames[0]) if plain else TPGMM(mixture.priors, frames)
