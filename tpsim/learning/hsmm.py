"""Hidden semi-Markov model: states with explicit durations, plain or seen from frames.

After S.-Z. Yu, "Hidden semi-Markov models", Artificial Intelligence 174, 2010; the tutorial's
demo_trajHSMM01.
"""

from collections.abc import Sequence

from tpsim.border import read
from tpsim.checks import Seed
from tpsim.learning.fit import Start
from tpsim.learning.fit_states import Emissions, Sequences, fit_states
from tpsim.learning.hidden import Observed
from tpsim.learning.hmm import HiddenStates
from tpsim.learning.markov import Topology
from tpsim.learning.semi_markov import SemiMarkovChain, Spread
from tpsim.learning.subspace import Structure
from tpsim.manifold.manifold import Manifold


class HSMM(HiddenStates):
    """Hidden semi-Markov model: an HMM whose states last for explicit durations.

    Parameters
    ----------
    chain : SemiMarkovChain
        Initial probabilities, transitions and durations [steps] of the K states.
    emissions : GMM or TPGMM
        What the states look like; their priors do not count.
    history : (n,)
        Mean log-likelihood per sample of the data after every iteration of the fit.

    Notes
    -----
    :meth:`forward` and :meth:`state_probabilities` are the probability of *being* in a state:
    of all stays begun by then and not ended yet. The tutorial's MATLAB code takes the
    probability that a stay *ends*, which changes state half a stay late. A sequence given whole
    (``log_likelihood``, ``responsibilities``, ``viterbi``) ends together with its last stay.
    """


def fit_hsmm(
    sequences: Sequences,
    components: int,
    *,
    topology: Topology = "left-right",
    duration_spread: float = 0.1,
    covariance: str | Structure = "full",
    start: Start | Emissions = None,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    manifold: Manifold | Sequence[Manifold] | None = None,
    observed: Observed = None,
    rng: Seed = None,
) -> HSMM:
    """Fit a hidden semi-Markov model by EM over all segmentations of the sequences.

    Parameters
    ----------
    sequences : sequence of Demonstration, or of (T_m, D) arrays
        As in :func:`fit_hmm`.
    components : int
        Number of states K.
    topology : str
        ``"left-right"`` or ``"any"``, as in :func:`fit_hmm`; no state follows itself.
    duration_spread : float
        The standard deviation of a duration is never below this share of the mean stay T / K:
        a handful of demonstrations says little about it.
    covariance, start, ridge, tolerance, max_iterations, manifold, observed, rng
        As in :func:`fit_hmm`.

    Returns
    -------
    HSMM
        Its ``history[-1]`` is the likelihood of the model returned.

    Raises
    ------
    ArgumentError
        Sequences or options without a finite answer; the message says which.

    Notes
    -----
    Departures from the tutorial's code, which counts the durations along the most likely states
    of all demonstrations chained into one, the first stay one step too long, and adds 10 steps^2
    to their variance: here every demonstration is its own sequence, durations are re-estimated
    by EM from all segmentations, and ``duration_spread`` is the only floor.
    """
    duration_spread = read("duration_spread", duration_spread, Spread)

    def chain_of(components: int, topology: Topology, stay: float) -> SemiMarkovChain:
        return SemiMarkovChain.of(components, topology, stay, duration_spread)

    return HSMM(
        *fit_states(
            sequences,
            components,
            chain_of,
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
