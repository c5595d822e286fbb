"""Choosing by demonstrations that were left out: what predicts them best is kept."""

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from functools import partial
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian

FOLDS = 5  # at most: more demonstrations are left out in groups
WITHOUT_CHOICE = 8  # components, where too few demonstrations leave no choice
LEAST = 3  # fewer demonstrations leave nothing to learn from when one is left out

Key = TypeVar("Key", bound=Hashable)


class Retriever(Protocol):
    """A learned movement over a clock of its own."""

    def __call__(self, frames: Sequence[Frame | None]) -> Gaussian:
        """Movement in the frames of a situation: mean (T, D), covariance (T, D, D)."""


Fit = Callable[[list[Demonstration]], Retriever]


def left_out_error(fit: Fit, demonstrations: Sequence[Demonstration]) -> float:
    """Root mean square distance [m] of demonstrations to what the others say of them.

    Parameters
    ----------
    fit
        Learns from a list of demonstrations.
    demonstrations
        At least two, on one clock (:func:`tpsim.retrieval.clock.on_one_clock`).
    """
    squares = [(apart**2).sum(1).mean() for apart, _ in _left_out(fit, demonstrations)]
    return float(np.sqrt(np.mean(squares)))


def left_out_scale(fit: Fit, demonstrations: Sequence[Demonstration]) -> float | None:
    """Factor that makes the covariance as large as the errors of demonstrations left out.

    The mean over their samples of the squared Mahalanobis distance, by the dimension: the
    likeliest factor. None with fewer than three demonstrations.
    """
    if len(demonstrations) < LEAST:
        return None
    squares = [
        np.einsum("ti,tij,tj->t", apart, path.precision, apart).mean() / path.dim
        for apart, path in _left_out(fit, demonstrations)
    ]
    return float(np.mean(squares))


def choose(
    candidates: Mapping[Key, Fit], demonstrations: Sequence[Demonstration], otherwise: Key
) -> tuple[Key, dict[Key, float]]:
    """Candidate that predicts demonstrations best that were left out, and the errors of all [m].

    With a single candidate, or fewer than three demonstrations, ``otherwise`` is taken and there
    are no errors.
    """
    if len(candidates) < 2 or len(demonstrations) < LEAST:
        return otherwise, {}
    errors = {key: left_out_error(fit, demonstrations) for key, fit in candidates.items()}
    return min(errors, key=errors.__getitem__), errors


def choose_components(
    fit: Callable[[int, list[Demonstration]], Retriever],
    numbers: Sequence[int],
    demonstrations: Sequence[Demonstration],
) -> tuple[int, dict[int, float]]:
    """Number of components that predicts demonstrations best, and the errors of all [m].

    ``fit(K, demonstrations)`` learns with K components. Without a choice, as :func:`choose` says,
    the number nearest to 8 is taken.
    """
    nearest = min(numbers, key=lambda K: abs(K - WITHOUT_CHOICE))
    return choose({K: partial(fit, K) for K in numbers}, demonstrations, nearest)


def _left_out(
    fit: Fit, demonstrations: Sequence[Demonstration]
) -> Iterator[tuple[NDArray, Gaussian]]:
    """Error (T, D) of every demonstration, and its prediction by the others."""
    folds = min(FOLDS, len(demonstrations))
    for fold in range(folds):
        movement = fit([d for m, d in enumerate(demonstrations) if m % folds != fold])
        for held_out in demonstrations[fold::folds]:
            path = movement(held_out.frames)
            yield held_out.data - path.mean, path
