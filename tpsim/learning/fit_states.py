"""EM for hidden states: a chain of them, and the mixture that they emit, in R^n or on manifolds."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import Seed, bound, choice, whole
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.em import Mixture, maximise, project, regularisation
from tpsim.learning.fit import Seen, Start, seen_as_data, seen_by_frames
from tpsim.learning.fit_on import begun, samples_on
from tpsim.learning.gmm import GMM, fit_gmm
from tpsim.learning.hidden import Observed
from tpsim.learning.markov import MarkovChain, Topology
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.subspace import Structure, structure_of
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold
from tpsim.timeline import check_even

Chain = MarkovChain | SemiMarkovChain
Emissions = GMM | TPGMM
Sequences = Demonstration | Sequence[Demonstration] | Sequence[ArrayLike]


def fit_states(
    sequences: Sequences,
    components: int,
    chain_of: Callable[[int, Topology, float], Chain],
    *,
    topology: Topology,
    covariance: str | Structure,
    start: Start | Emissions,
    ridge: float | None,
    tolerance: float,
    max_iterations: int,
    manifold: Manifold | Sequence[Manifold] | None,
    observed: Observed,
    rng: Seed,
) -> tuple[Chain, Emissions, np.ndarray]:
    """EM for either chain and either kind of emissions; see :func:`fit_hmm`.

    ``chain_of(components, topology, stay)`` makes the chain to begin with.
    """
    choice("topology", topology, ("left-right", "any"))
    tolerance = bound("tolerance", tolerance)
    max_iterations = whole("max_iterations", max_iterations)
    components = whole("components", components, least=1)
    if not isinstance(start, Emissions):
        start = _begin(
            sequences,
            components,
            observed,
            covariance=covariance,
            start=start,
            ridge=ridge,
            manifold=manifold,
            rng=rng,
        )
    seen = _seen(sequences, components, start, observed)
    views, lengths = seen.views, seen.lengths
    chain = chain_of(components, topology, sum(lengths) / len(lengths) / components)
    if topology == "left-right":
        start = _in_order(start, views, lengths, seen.observed)
    structure = structure_of(covariance)
    curved = any(isinstance(frame, RiemannianGaussian) for frame in _frames(start))
    learner = (_Curved if curved else _Flat)(seen, start, structure, ridge)
    history: list[float] = []
    while True:
        densities = np.split(learner.log_densities(), np.cumsum(lengths)[:-1])
        found = chain.expectation(densities)
        history.append(found.log_likelihood.sum() / learner.samples.count)
        converged = len(history) > 1 and history[-1] - history[-2] < tolerance
        if converged or len(history) > max_iterations:
            break
        learner.maximise(np.concatenate(found.responsibilities))
        chain = chain.maximised(found)
    model = _emissions(type(start), learner.priors, learner.frames())
    return (
        chain,
        replace(model, samples=learner.samples.count, structure=structure),
        np.array(history),
    )


class _Flat:
    """The emissions of R^n as EM moves them."""

    def __init__(self, seen: Seen, start: Emissions, structure: Structure, ridge: float | None):
        self.samples, self._structure = seen.samples(), structure
        priors = np.maximum(start.priors, np.finfo(float).tiny)
        mixture = Mixture.of(priors, _frames(start), self.samples)
        _, parts = self.samples.expectation(mixture.priors, mixture.components)
        self._limits = regularisation(self.samples, ridge, parts)
        self._mixture = project(mixture, structure, self._limits)

    def log_densities(self) -> np.ndarray:
        """Of every sample in every state, (N, K)."""
        return self.samples.log_densities(self._mixture.components)

    def maximise(self, h: np.ndarray) -> None:
        """M-step for responsibilities (N, K)."""
        moments = self.samples.moments(h)
        self._mixture = maximise(moments, self._mixture, self._structure, self._limits)

    @property
    def priors(self) -> np.ndarray:
        """Mixing coefficients (K,)."""
        return self._mixture.priors

    def frames(self) -> tuple[Gaussian, ...]:
        """One Gaussian (K,) per frame."""
        return self._mixture.frames(self.samples)


class _Curved:
    """The emissions on manifolds as EM moves them."""

    def __init__(self, seen: Seen, start: Emissions, structure: Structure, ridge: float | None):
        frames = [g for g in _frames(start) if isinstance(g, RiemannianGaussian)]
        self.samples, self._structure = samples_on([g.manifold for g in frames], seen), structure
        self._model = self.samples.charted(start.priors, frames)
        self._model, self._limits = begun(self.samples, self._model, structure, ridge)

    def log_densities(self) -> np.ndarray:
        """Of every sample in every state, (N, K)."""
        return self.samples.log_densities(self._model)

    def maximise(self, h: np.ndarray) -> None:
        """M-step for responsibilities (N, K)."""
        moments = self.samples.moments(h, self._model.bases)
        found = maximise(moments, self._model.mixture, self._structure, self._limits)
        self._model, self._limits = self.samples.moved(
            found, self._model.bases, self._limits, self._structure
        )

    @property
    def priors(self) -> np.ndarray:
        """Mixing coefficients (K,)."""
        return self._model.mixture.priors

    def frames(self) -> tuple[Gaussian, ...]:
        """One Gaussian (K,) per frame."""
        return self.samples.gaussians(self._model)


def _have_views(sequences: Sequences) -> bool:
    """Whether these are demonstrations with something that their frames saw."""
    some = sequences if isinstance(sequences, list | tuple) else [sequences]
    return bool(some) and all(isinstance(s, Demonstration) and s.observations for s in some)


def _begin(sequences: Sequences, components: int, observed: Observed, **options: Any) -> Emissions:
    """A mixture to begin with: of what the frames saw, if there are any."""
    if _have_views(sequences):
        return fit_tp_gmm(sequences, components, observed=observed, **options)
    return fit_gmm(sequences, components, **options)


def _seen(sequences: Sequences, components: int, start: Emissions, observed: Observed) -> Seen:
    """Samples (N, d_j) as the emissions see them, and the lengths of the sequences."""
    tp = isinstance(start, TPGMM)
    if observed is not None and not tp:
        raise ArgumentError(
            "observed says which samples frames saw, and these sequences have no frames; leave it "
            "out, or give demonstrations with frames or observations"
        )
    seen = seen_by_frames(sequences, observed) if tp else seen_as_data(sequences)
    if seen.stamps is not None:
        check_even("demonstration", seen.stamps)
    expected = [(components, view.shape[-1]) for view in seen.views]
    given = [gaussian.mean.shape for gaussian in _frames(start)]
    if given != expected:
        raise ArgumentError(
            f"start has means of shapes {given}, the sequences of lengths {seen.lengths} ask for "
            f"{expected}; give components, sequences and start that fit together"
        )
    return seen


def _frames(emissions: Emissions) -> tuple[Gaussian, ...]:
    return emissions.frames if isinstance(emissions, TPGMM) else (emissions.gaussians,)


def _emissions(kind: type, priors: np.ndarray, frames: Sequence[Gaussian]) -> Emissions:
    return TPGMM(priors, tuple(frames)) if kind is TPGMM else GMM(priors, frames[0])


def _in_order(
    start: Emissions,
    views: list[np.ndarray],
    lengths: list[int],
    observed: np.ndarray | None = None,
) -> Emissions:
    """The same mixture with its components ordered by their mean time."""
    if isinstance(start, TPGMM):
        h = start.responsibilities(views, observed)
    else:
        h = start.responsibilities(views[0])
    progress = np.concatenate([np.linspace(0.0, 1.0, length) for length in lengths])
    order = np.argsort(progress @ h / h.sum(0), kind="stable")
    frames = [gaussian[order] for gaussian in _frames(start)]
    return _emissions(type(start), start.priors[order], frames)
