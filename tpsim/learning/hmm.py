"""Hidden Markov models over Gaussian components, plain or seen from frames.

The tutorial names them as alternatives to a mixture (Section 5.2, its footnote on the sequence of
states, and demo_trajHSMM01); the equations are those of L. R. Rabiner, Proc. IEEE 77(2), 1989.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import Seed, frozen_array, generator, matrix
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.fit import Start
from tpsim.learning.fit_states import Chain, Emissions, Sequences, fit_states
from tpsim.learning.gmm import log_priors
from tpsim.learning.hidden import Observed
from tpsim.learning.markov import MarkovChain, Topology
from tpsim.learning.subspace import Structure
from tpsim.learning.tp_gmm import TPGMM
from tpsim.manifold.manifold import Manifold
from tpsim.timeline import check_even

FARTHEST = 1e12  # [nats]: beyond it the digits of a log density are below one


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
            width = emissions.gaussians.mean.shape[-1]
            joint = emissions.log_joint(matrix("observations", observations, width))
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
    manifold: Manifold | Sequence[Manifold] | None = None,
    observed: Observed = None,
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
    ridge, tolerance, max_iterations, manifold, observed, rng
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
            manifold=manifold,
            observed=observed,
            rng=rng,
        )
    )
