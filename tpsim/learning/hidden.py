"""Samples that not every frame saw: EM with the marginal likelihood of what was seen.

The covariances of a TP-GMM are block-diagonal over frames (Eq. 49 is a product over them), so what
a hidden frame would have seen integrates to one: in each sample only the frames count that saw it.
The M-step (Eqs 50-52) is that of the tutorial with the mean and covariance of every frame over the
samples that it saw: EM is exact, and the likelihood never falls.
"""

import warnings
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from tpsim.arrays import array_of
from tpsim.checks import entries
from tpsim.errors import ArgumentError, DataWarning
from tpsim.gaussian import Gaussian
from tpsim.learning.em import LITTLE
from tpsim.learning.moments import Moments
from tpsim.learning.statistics import Components, Samples

Observed = ArrayLike | Sequence[ArrayLike] | None
"""Which samples every frame saw, (N, P), or one (T_m, P) for every demonstration; None: all."""


def observed_of(observed: object, lengths: Sequence[int], frames: int) -> np.ndarray | None:
    """Which of the samples (N,) every frame saw, (N, P); None where all frames saw all of them.

    Parameters
    ----------
    observed : (N, P), or one (T_m, P) for every sequence
        True where a frame saw the sample.
    lengths : sequence of int
        Numbers of samples T_m of the sequences.
    frames : int
        P.

    Raises
    ------
    ArgumentError
        No truth values, shapes that do not fit, or a frame that saw fewer than two samples.
    """
    if observed is None:
        return None
    total = sum(lengths)
    parts = [array_of("observed", observed)] if _is_one(observed) else entries("observed", observed)
    masks = [array_of(f"observed[{m}]", part) for m, part in enumerate(parts)]
    shapes = [mask.shape for mask in masks]
    each = [(length, frames) for length in lengths]
    if any(mask.dtype != bool for mask in masks) or shapes not in ([(total, frames)], each):
        raise ArgumentError(
            f"observed has {', '.join(f'{m.dtype} of shape {m.shape}' for m in masks)}; give True "
            f"or False for every sample and frame, ({total}, {frames}) or one array for each of "
            f"{len(lengths)} demonstrations, of {each[0]} and so on"
        )
    seen = np.concatenate(masks)
    counts = seen.sum(0)
    if (counts < 2).any():
        j = int(counts.argmin())
        raise ArgumentError(
            f"frame {j} saw {counts[j]} of {total} samples; a frame that never saw enough to learn "
            "from, at least 2, is none: leave it out (Demonstration.seen_from)"
        )
    return None if seen.all() else seen


def _is_one(observed: object) -> bool:
    if not isinstance(observed, list | tuple):
        return True
    return bool(observed) and array_of("observed[0]", observed[0]).ndim == 1


def filled(views: Sequence[np.ndarray], observed: np.ndarray | None) -> list[np.ndarray]:
    """Views (N, d_j) with samples that were not seen as the one that was seen last before.

    What is there does not count; it only has to be a point. Views of other lengths stay.
    """
    if observed is None or any(len(view) != len(observed) for view in views):
        return list(views)
    rows = np.arange(len(observed))
    return [
        view[np.maximum.accumulate(np.where(seen, rows, seen.argmax()))]
        for view, seen in zip(views, observed.T, strict=True)
    ]


class PartlySeen(Samples):
    """Samples of which every frame saw some: features are zero where a frame saw nothing.

    A constant of every frame's own, in the last features, is one where it saw a sample.

    Parameters
    ----------
    views : sequence of P arrays (N, d_j)
    observed : (N, P)
    """

    def __init__(self, views: Sequence[np.ndarray], observed: np.ndarray):
        dims = [view.shape[1] for view in views]
        order = [j for dim in sorted(set(dims)) for j, d in enumerate(dims) if d == dim]
        self._observed = np.ascontiguousarray(observed.T[order], float)
        self._own = len(order)
        super().__init__(views)

    def remembered(self, time: np.ndarray, lengths: Sequence[int]) -> None:  # type: ignore[override]
        """Nothing: moments of runs do not say which frames saw them."""
        return None

    def _features(self, rows: slice) -> np.ndarray:
        seen = self._observed[:, rows]
        features = super()._features(rows)
        features[1:] *= seen[self._owners]
        return np.concatenate([features, seen])

    @property
    def _owners(self) -> np.ndarray:
        """Which frame, in the order of the groups, each feature but the first belongs to."""
        found, first = [], 0
        for group, d in zip(self.groups, self.dims, strict=True):
            frames = np.arange(first, first + len(group))
            found += [np.repeat(frames, d), np.repeat(frames, d * (d + 1) // 2)]
            first += len(group)
        return np.concatenate(found)

    def _weights(self, components: Sequence[Components]) -> np.ndarray:
        weights = super()._weights(components)
        weights[:, 0] = 0.0
        constants = [
            Gaussian.trusted(part.mean, part.covariance).log_density(centre[:, None])
            for part, centre in zip(components, self._centres, strict=True)
        ]
        return np.concatenate([weights, *(one.T for one in constants)], axis=1)

    def _moments(self, total: np.ndarray) -> Moments:
        """Every frame's moments over the samples that it saw."""
        total, seen = total[:, : -self._own], total[:, -self._own :]
        share = total[:, :1] / np.maximum(seen, np.finfo(float).tiny)
        moments = super()._moments(
            np.concatenate([total[:, :1], total[:, 1:] * share[:, self._owners]], axis=1)
        )
        ends = np.cumsum([len(group) for group in self.groups])[:-1]
        return Moments(
            moments.weight,
            moments.mean,
            moments.scatter,
            tuple(part.T for part in np.split(seen, ends, axis=1)),
        )

    def moments(self, responsibilities: np.ndarray) -> Moments:
        """Moments as of :class:`Samples`; of all that a frame saw where it saw too little."""
        return widened(super().moments(responsibilities), self.total)

    def expectation(
        self, priors: np.ndarray, components: Sequence[Components]
    ) -> tuple[float, Moments]:
        """Mean log-likelihood of what was seen, and moments as of :meth:`moments`."""
        log_likelihood, moments = super().expectation(priors, components)
        return log_likelihood, widened(moments, self.total)


def widened(moments: Moments, of_all: Callable[[], Moments]) -> Moments:
    """Moments in which frames that saw too little of a component have those of all they saw."""
    if moments.seen is None or not any((seen <= LITTLE).any() for seen in moments.seen):
        return moments
    total = of_all()
    means, scatters = [], []
    for mean, scatter, whole, spread, seen in zip(
        moments.mean, moments.scatter, total.mean, total.scatter, moments.seen, strict=True
    ):
        little = (seen <= LITTLE)[..., None]
        means.append(np.where(little, whole, mean))
        scatters.append(np.where(little[..., None], spread, scatter))
    return Moments(moments.weight, tuple(means), tuple(scatters), moments.seen)


def too_little_seen(moments: Moments, groups: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Components and frames that saw too little of them."""
    if moments.seen is None:
        return []
    return sorted(
        (int(k), group[g])
        for group, seen in zip(groups, moments.seen, strict=True)
        for g, k in np.argwhere(seen <= LITTLE)
    )


def say_if_hidden(found: Sequence[tuple[int, int]]) -> None:
    """Give a DataWarning that names components and frames that saw too little of them."""
    if found:
        words = ", ".join(f"frame {j} of component {k}" for k, j in found)
        warnings.warn(
            f"hidden frames saw no more than one sample's worth of a component: {words}; they are "
            "about as wide there as all that the frame saw. Ask for fewer components, or show more",
            DataWarning,
            stacklevel=3,
        )
