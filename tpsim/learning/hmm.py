"""Hidden Markov models over Gaussian components, plain or seen from frames.

The tutorial names them as alternatives to a mixture (Section 5.2, its footnote on the sequence of
states, and demo_trajHSMM01); the equations are those of L. R. Rabiner, Proc. IEEE 77(2), 1989.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import Seed, bound, choice, frozen_array, generator, matrix, whole
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.em import Mixture, maximise, project, regularisation
from tpsim.learning.fit import Seen, Start, seen_as_data, seen_by_frames
from tpsim.learning.gmm import GMM, fit_gmm, log_priors
from tpsim.learning.markov import MarkovChain, Topology
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.statistics import Samples
from tpsim.learning.subspace import Structure, structure_of
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.timeline import check_even

FARTHEST = 1e12  # [nats]: beyond it the digits of a log density are below one

Chain = MarkovChain | SemiMarkovChain
Emissions = GMM | TPGMM
Sequences = Demonstration | Sequence[Demonstration] | Sequence[ArrayLike]


@dataclass(frozen=True, eq=False)
class HiddenStates(Stored):
    """What HMM and HSMM have in common: a chain of K states, and what the states look like."""

    chain: Chain
    emissions: Emissions
    history: np.ndarray = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        if not isinstance(self.chain, Chain) or not isinstance(self.emissions, Emissions):
            raise ArgumentError("give a (semi-)Markov chain, and emissions: a GMM or a TPGMM")
        object.__setattr__(self, "history", frozen_array("history", self.history))
        if self.emissions.components != len(self.chain.initial):
            raise ArgumentError(
                f"the chain has {len(self.chain.initial)} states and the emissions "
                f"{self.emissions.components} components; give as many of both"
            )

    @property
    def components(self) -> int:
        """Number of states K."""
        return self.emissions.components

    @property
    def gaussians(self) -> Gaussian:
        """Gaussians (..., K, D) in common coordinates; a task-parameterized model adapts first."""
        if isinstance(self.emissions, TPGMM):
            raise ArgumentError("this model lives in frames; call adapt(frames) first")
        return self.emissions.gaussians

    def adapt(
        self,
        frames: Sequence[Frame | None],
        ridge: float | None = None,
        prior: Gaussian | None = None,
    ) -> Self:
        """The same states for new frames, Eqs (5-6); options as in :meth:`TPGMM.adapt`."""
        if not isinstance(self.emissions, TPGMM):
            raise ArgumentError("this model has no frames to adapt; fit it to Demonstrations")
        return replace(self, emissions=self.emissions.adapt(frames, ridge, prior))

    def log_densities(self, observations: Demonstration | ArrayLike) -> np.ndarray:
        """Log density of every sample in every state, (T, K).

        Parameters
        ----------
        observations : Demonstration, (T, D) array, or P arrays (T, d_j)
            One sequence. Arrays per frame are for a task-parameterized model.
        """
        emissions = self.emissions
        if isinstance(observations, Demonstration):
            check_even("demonstration", [observations.time])
            observations = observations if isinstance(emissions, TPGMM) else observations.data
        if isinstance(emissions, TPGMM):
            joint = emissions.log_joint(observations)
        else:
            joint = emissions.log_joint(matrix("observations", observations, emissions.dim))
        if not np.abs(joint).max() < FARTHEST:
            raise ArgumentError("observations are far from all states; check unit and origin")
        return joint - log_priors(emissions.priors)

    def log_likelihood(self, observations: Demonstration | ArrayLike) -> float:
        """Log-likelihood of one whole sequence [nats]."""
        return float(self.chain.expectation([self.log_densities(observations)]).log_likelihood[0])

    def responsibilities(self, observations: Demonstration | ArrayLike) -> np.ndarray:
        """P(s_t | the whole sequence), (T, K)."""
        return self.chain.expectation([self.log_densities(observations)]).responsibilities[0]

    def forward(self, observations: Demonstration | ArrayLike) -> np.ndarray:
        """P(s_t | the sequence until t), (T, K): the normalised forward variable."""
        return self.chain.filtered(self.log_densities(observations))

    def viterbi(self, observations: Demonstration | ArrayLike) -> np.ndarray:
        """Most likely states (T,) of one whole sequence."""
        return self.chain.viterbi(self.log_densities(observations))

    def state_probabilities(self, steps: int) -> np.ndarray:
        """P(s_t) for a movement yet to be made, (steps, K): the forward variable alone."""
        return self.chain.probabilities(steps)

    def state_sequence(self, steps: int) -> np.ndarray:
        """Most likely state at every step of a movement yet to be made, (steps,)."""
        return self.state_probabilities(steps).argmax(1)

    def sample_states(self, steps: int, rng: Seed) -> np.ndarray:
        """Draw the states of a movement yet to be made, (steps,); ``rng`` may be a seed."""
        return self.chain.sample(steps, generator("rng", rng))


class HMM(HiddenStates):
    """Hidden Markov model.

    Parameters
    ----------
    chain : MarkovChain
        Initial probabilities and transitions of the K states.
    emissions : GMM or TPGMM
        What the states look like; their priors do not count.
    history : (n,)
        Mean log-likelihood per sample of the data after every iteration of the fit.
    """


def fit_hmm(
    sequences: Sequences,
    components: int,
    *,
    topology: Topology = "left-right",
    covariance: str | Structure = "full",
    start: Start | Emissions = None,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    rng: Seed = None,
) -> HMM:
    """Fit a hidden Markov model by EM (Baum-Welch).

    Parameters
    ----------
    sequences : sequence of Demonstration, or of (T_m, D) arrays
        Movements of any lengths. From demonstrations with frames or observations the model
        learns what every frame sees (a TP-HMM, with ``adapt``), else the data. The model counts
        samples: demonstrations must be evenly sampled, at one rate or in equal numbers.
    components : int
        Number of states K.
    topology : str
        ``"left-right"``: the states, ordered by their mean time, follow each other and the
        movement begins in the first; ``"any"``: every state may follow every other.
    covariance : str or structure
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.
    start : str, GMM or TPGMM, optional
        A mixture to begin with as it is, or how to fit one first.
    ridge, tolerance, max_iterations, rng
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.

    Returns
    -------
    HMM
        Its ``history[-1]`` is the likelihood of the model returned.

    Raises
    ------
    ArgumentError
        Sequences or options without a finite answer; the message says which.
    """
    return HMM(
        *fit_states(
            sequences,
            components,
            MarkovChain.of,
            topology=topology,
            covariance=covariance,
            start=start,
            ridge=ridge,
            tolerance=tolerance,
            max_iterations=max_iterations,
            rng=rng,
        )
    )


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
        start = _mixture(sequences, components, covariance, start, ridge, rng)
    seen = _seen(sequences, components, start)
    views, lengths = seen.views, seen.lengths
    chain = chain_of(components, topology, sum(lengths) / len(lengths) / components)
    if topology == "left-right":
        start = _in_order(start, views, lengths)
    structure, samples = structure_of(covariance), Samples(views)
    mixture = Mixture.of(np.maximum(start.priors, np.finfo(float).tiny), _frames(start), samples)
    _, parts = samples.expectation(mixture.priors, mixture.components)
    limits = regularisation(samples, ridge, parts)
    mixture = project(mixture, structure, limits)
    history: list[float] = []
    while True:
        densities = np.split(samples.log_densities(mixture.components), np.cumsum(lengths)[:-1])
        found = chain.expectation(densities)
        history.append(found.log_likelihood.sum() / samples.count)
        converged = len(history) > 1 and history[-1] - history[-2] < tolerance
        if converged or len(history) > max_iterations:
            break
        moments = samples.moments(np.concatenate(found.responsibilities))
        mixture = maximise(moments, mixture, structure, limits)
        chain = chain.maximised(found)
    model = _emissions(type(start), mixture.priors, mixture.frames(samples))
    return chain, replace(model, samples=samples.count, structure=structure), np.array(history)


def _mixture(
    sequences: Sequences,
    components: int,
    covariance: str | Structure,
    start: Start,
    ridge: float | None,
    rng: Seed,
) -> Emissions:
    """Mixture to begin with, fitted to the same samples."""
    fit = fit_tp_gmm if _have_views(sequences) else fit_gmm
    return fit(sequences, components, covariance=covariance, start=start, ridge=ridge, rng=rng)


def _have_views(sequences: Sequences) -> bool:
    """Whether these are demonstrations with something that their frames saw."""
    some = sequences if isinstance(sequences, list | tuple) else [sequences]
    return bool(some) and all(isinstance(s, Demonstration) and s.observations for s in some)


def _seen(sequences: Sequences, components: int, start: Emissions) -> Seen:
    """Samples (N, d_j) as the emissions see them, and the lengths of the sequences."""
    tp = isinstance(start, TPGMM)
    seen = seen_by_frames(sequences) if tp else seen_as_data(sequences)
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


def _in_order(start: Emissions, views: list[np.ndarray], lengths: list[int]) -> Emissions:
    """The same mixture with its components ordered by their mean time."""
    if isinstance(start, TPGMM):
        h = start.responsibilities(views)
    else:
        h = start.responsibilities(views[0])
    progress = np.concatenate([np.linspace(0.0, 1.0, length) for length in lengths])
    order = np.argsort(progress @ h / h.sum(0), kind="stable")
    frames = [gaussian[order] for gaussian in _frames(start)]
    return _emissions(type(start), start.priors[order], frames)
