"""How much demonstrations know: samples that are independent, and what precision they support.

A hand that is led moves slowly against 100 samples a second, so that neighbours say nearly the
same: a demonstration of 800 samples may hold ten independent ones.
"""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy import fft
from scipy.special import chdtri

from tpsim.checks import Floats, choice, column_or_matrix, entries, number
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError

WITHOUT_VARIANCE = 1e-12
"""Share of the size or largest variance of the samples below which a direction is constant."""

Moment = Literal["mean", "covariance"]
"""What is estimated from the samples."""


def effective_samples(
    demonstrations: Sequence[Demonstration] | Sequence[ArrayLike] | Demonstration | ArrayLike,
    of: Moment = "mean",
) -> float:
    """Independent samples that would tell as much as these, which follow each other in time.

    With N samples in M independent sequences, autocorrelation rho_k at lag k and N_k pairs at
    that lag, the mean of all samples has the variance of N_eff independent ones,
    N_eff = N^2 / (N + 2 sum_k N_k rho_k); their covariance that of the same with rho_k^2. For a
    long autoregressive process of first order with coefficient a these are N (1 - a) / (1 + a)
    and N (1 - a^2) / (1 + a^2). Sequences that do not move count as one sample each, white noise
    as all its samples; noise that alternates counts no more than that.

    Parameters
    ----------
    demonstrations : sequence of Demonstration or of arrays (T,) or (T, D)
        Evenly sampled, of lengths of their own; one alone is a sequence of one. Of a
        demonstration its ``data`` counts: give ``observations[j]`` for what frame j saw, and
        what is left after the movement's mean for a model over time.
    of : str
        ``"mean"``, or ``"covariance"``: the number that a precision is known from.

    Returns
    -------
    float
        Between 1 and N.

    Raises
    ------
    ArgumentError
        No samples, other numbers of columns, values that are not finite.

    Notes
    -----
    The autocorrelation of several columns is tr(Gamma_0^-1 Gamma_k) / D, which does not depend
    on units, rotations or scalings; deviations are those from the mean of all sequences. The sum
    over lags ends by Geyer's initial monotone sequence (Practical Markov Chain Monte Carlo,
    Statistical Science 7, 1992): where a pair of neighbouring lags is no longer positive, or
    else rises again, only noise follows.
    """
    choice("of", of, ("mean", "covariance"))
    sequences = _sequences(demonstrations)
    lengths = np.array([len(x) for x in sequences])
    total, longest = int(lengths.sum()), int(lengths.max())
    pairs = np.maximum(lengths - np.arange(longest)[:, None], 0).sum(1)
    rho = _initial_monotone(_autocorrelation(sequences, pairs))
    if of == "covariance":
        rho = rho**2
    lags = np.arange(1, len(rho))
    return float(total**2 / (total + max(0.0, 2 * pairs[lags] @ rho[lags])))


def deviation_interval(samples: float, confidence: float = 0.95) -> tuple[float, float]:
    """Factors on a standard deviation between which the true one lies.

    For normal samples of which ``samples`` are independent, (N - 1) s^2 / sigma^2 is chi-squared
    with N - 1 degrees of freedom. Precision has the squares of the inverse factors.

    Parameters
    ----------
    samples : float
        As of :func:`effective_samples`, above 1.
    confidence : float
        Between 0 and 1.
    """
    samples = number("samples", samples, above=1)
    confidence = number("confidence", confidence, above=0, below=1)
    freedom = samples - 1
    tails = (1 - confidence) / 2
    low, high = chdtri(freedom, [tails, 1 - tails])
    with np.errstate(divide="ignore"):  # of hardly one sample nothing is known
        return float(np.sqrt(freedom / low)), float(np.sqrt(freedom / high))


def demonstrations_wanted(
    demonstrations: Sequence[Demonstration] | Sequence[ArrayLike],
    within: float = 2.0,
    confidence: float = 0.95,
) -> int:
    """Demonstrations like these that tell standard deviations within a factor, on average.

    As many as it takes until the upper factor of :func:`deviation_interval` is at most
    ``within``, each adding as many independent samples of the covariance as these do on average;
    more than ``len(demonstrations)`` says that these are too few.

    Parameters
    ----------
    demonstrations : sequence of Demonstration or of arrays
        As of :func:`effective_samples`.
    within : float
        Factor above 1: with 2, a precision is known within four times.
    confidence : float
        Between 0 and 1.
    """
    within = number("within", within, above=1)
    count = len(_sequences(demonstrations))
    each = effective_samples(demonstrations, "covariance") / count

    def known(wanted: int) -> bool:
        samples = wanted * each
        return samples > 1 and deviation_interval(samples, confidence)[1] <= within

    least, most = 0, 1
    while not known(most):
        least, most = most, 2 * most
    while most - least > 1:
        middle = (least + most) // 2
        least, most = (least, middle) if known(middle) else (middle, most)
    return most


def _sequences(given: object) -> list[Floats]:
    """Arrays (T_i, D) of what was given."""
    alone = isinstance(given, Demonstration) or (isinstance(given, np.ndarray) and given.ndim == 1)
    given = [given] if alone else given
    found = [
        column_or_matrix(
            f"demonstrations[{i}]", one.data if isinstance(one, Demonstration) else one
        )
        for i, one in enumerate(entries("demonstrations", given))
    ]
    if not found:
        raise ArgumentError("no demonstrations were given; give at least one")
    columns = sorted({x.shape[1] for x in found})
    if len(columns) > 1:
        raise ArgumentError(f"demonstrations have {columns} columns; give the same number in all")
    return found


def _autocorrelation(sequences: list[Floats], pairs: Floats) -> Floats:
    """Mean autocorrelation (lags,) of whitened columns about the mean of all sequences."""
    stacked = np.concatenate(sequences)
    mean, deviation = stacked.mean(0), stacked.std(0)
    varying = deviation > WITHOUT_VARIANCE * np.abs(stacked).max(0)
    if not varying.any():
        return np.ones(len(pairs))  # a sequence that does not move is one sample
    # Columns of equal variance first, so that units do not decide what is without variance.
    scaled = [(x - mean)[:, varying] / deviation[varying] for x in sequences]
    stacked = np.concatenate(scaled)
    variance, axes = np.linalg.eigh(stacked.T @ stacked / len(stacked))
    kept = variance > WITHOUT_VARIANCE * variance[-1]
    whiten = axes[:, kept] / np.sqrt(variance[kept])
    size = fft.next_fast_len(2 * len(pairs), real=True)
    power = np.zeros(size // 2 + 1)
    for x in scaled:
        power += (np.abs(fft.rfft(x @ whiten, size, axis=0)) ** 2).sum(1)
    products: Floats = fft.irfft(power, size)[: len(pairs)] / pairs
    return products / products[0]


def _initial_monotone(rho: Floats) -> Floats:
    """Autocorrelations (lags,) up to the lag from which on only noise follows."""
    pairs = rho[: len(rho) - len(rho) % 2].reshape(-1, 2).sum(1)
    end = int(np.argmax(np.append(pairs, 0.0) <= 0))
    lowered = np.minimum.accumulate(pairs[:end]) / pairs[:end]
    # A last lag without a partner stays where all before it did.
    rest = rho[2 * end :] if end == len(pairs) else rho[:0]
    return np.concatenate([rho[: 2 * end] * np.repeat(lowered, 2), rest])
