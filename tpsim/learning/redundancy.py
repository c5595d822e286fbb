"""Frames that see the same (Section 9): what one frame saw, foretold from another one's view."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.border import Share, border, checked
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.learning.eigenframes import Samples, views_of

FLOOR = 1e-6
"""Share of a view's whole variance below which variance counts as none."""


@dataclass(frozen=True, eq=False)
class Redundancy:
    """Which frames say nothing that another one does not say.

    Parameters
    ----------
    unexplained : (P, P)
        Row j, column k: variance of what frame j saw that frame k does not foretell, over the
        variance that there is, at the worst moment and in the worst dimension; 0 where both see the
        same, about 1 or more where they do not.
    together : (P,)
        The same from all other frames at once.
    tolerance : float
        Below this a frame is redundant.
    """

    unexplained: np.ndarray
    together: np.ndarray
    tolerance: Share

    def __post_init__(self) -> None:
        checked(self)
        P = len(np.atleast_1d(self.together))
        if self.unexplained.shape != (P, P) or self.together.shape != (P,):
            raise ArgumentError(
                f"unexplained has shape {self.unexplained.shape} and together "
                f"{self.together.shape}; give (P, P) and (P,)"
            )

    @property
    def kept(self) -> tuple[int, ...]:
        """Frames that are enough: of those that see the same, the one that foretells most."""
        same = self.unexplained <= self.tolerance
        kept: list[int] = []
        for j in np.argsort(-same.sum(0), kind="stable"):
            if not same[j, kept].any():
                kept.append(int(j))
        return tuple(sorted(kept))

    @property
    def instead(self) -> dict[int, int]:
        """Redundant frames, and which kept one foretells each best."""
        kept = list(self.kept)
        others = [j for j in range(len(self.together)) if j not in kept]
        return {j: kept[int(self.unexplained[j, kept].argmin())] for j in others}

    def __str__(self) -> str:
        """Table with one line per frame."""
        lines = ["frame   unexplained by the best other   by all others"]
        for j, row in enumerate(self.unexplained):
            others = np.delete(np.arange(len(row)), j)
            best = (
                f"{row[others].min():.3g} ({others[row[others].argmin()]})" if len(row) > 1 else "-"
            )
            verdict = f"  sees what {self.instead[j]} sees" if j in self.instead else ""
            lines.append(f"{j:>5} {best:>31} {self.together[j]:>15.3g}{verdict}")
        return "\n".join(lines)


@border
def redundant_frames(
    demonstrations: Sequence[Demonstration], *, samples: Samples = 100, tolerance: Share = 0.05
) -> Redundancy:
    """Find frames that see the same of a movement (Section 9).

    What frame j saw in one demonstration is foretold from what frame k saw in it, by the affine
    map that fits all other demonstrations best. Two frames fixed to one thing foretell each other
    wherever that thing is and however they are turned; a frame elsewhere does not, as soon as the
    demonstrations show both in different places to each other.

    Parameters
    ----------
    demonstrations : sequence of Demonstration
        At least two, with the same frames.
    samples : int
        Samples of every movement, evenly over its time.
    tolerance : float
        Share of the variance, at any time, that may remain unexplained.

    Raises
    ------
    ArgumentError
        Fewer than two demonstrations, or frames that do not fit together.

    Notes
    -----
    Relevance (:func:`tpsim.frame_report`) finds frames that do not matter. Frames that see the
    same matter alike, and the product of Eq. (6) counts what they know twice: its covariance is
    half of what it should be. ``together`` is no reason to leave a frame out: a frame halfway
    between two others follows from both, but a TP-GMM without it cannot be precise there.
    """
    views = views_of(demonstrations, samples)
    N, P = len(demonstrations), len(views)
    if N < 2:
        raise ArgumentError("one demonstration was given; give two or more, which can differ")
    unexplained = np.zeros((P, P))
    for j, target in enumerate(views):
        for k, given in enumerate(views):
            unexplained[j, k] = 0.0 if j == k else _unexplained(target, given)
    everything = [
        np.concatenate([view for k, view in enumerate(views) if k != j] or [views[j][..., :0]], 2)
        for j in range(P)
    ]
    together = [_unexplained(view, rest) for view, rest in zip(views, everything, strict=True)]
    return Redundancy(unexplained, np.array(together), tolerance)


def _unexplained(target: np.ndarray, given: np.ndarray) -> float:
    """Variance of views (N, T, a) that others (N, T, b) do not foretell, over what there is."""
    y, x = _standard(target), _standard(given)
    x = np.concatenate([np.ones((*x.shape[:2], 1)), x], axis=2)
    grams, crosses = x.mT @ x, x.mT @ y
    rest = grams.sum(0) - grams, crosses.sum(0) - crosses
    error = y - x @ (np.linalg.pinv(rest[0], rcond=1e-10, hermitian=True) @ rest[1])
    left, there = (error**2).mean(0), y.var(0)  # (T, a): the worst moment counts
    # A view that never varies is foretold by anything, which says nothing.
    counted = y.var((0, 1)) > 0
    if not counted.any():
        return 1.0
    return float((left / np.maximum(there, FLOOR))[:, counted].max())


def _standard(view: np.ndarray) -> np.ndarray:
    """Views (N, T, d) with zero mean and unit variance; what does not vary is zero."""
    size = np.maximum(np.abs(view).max((0, 1)), 1e-300)
    centred = view / size - (view / size).mean((0, 1))
    deviation = centred.std((0, 1))
    return centred / np.where(deviation > 1e-12, deviation, np.inf)
