"""From samples and options to a fitted mixture: checks at the border, starts, and the best."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, finite_array
from tpsim.learning.em import Mixture, em, maximise, project, regularisation
from tpsim.learning.start import kmeans, split_in_time, spread_centres, standardised, time_of
from tpsim.learning.statistics import Samples
from tpsim.learning.subspace import Structure, structure_of

Start = str | tuple[np.ndarray, Sequence[Gaussian]] | None
"""``"time"``, ``"kmeans"``, priors and Gaussians of a model, or None for the best of both."""


Views = Sequence[Demonstration] | Sequence[ArrayLike]
"""Demonstrations, or what each of P frames saw, (N, d_j)."""


@dataclass(frozen=True, eq=False)
class Fit:
    """What EM found: the fields that GMM and TP-GMM share."""

    priors: np.ndarray
    frames: tuple[Gaussian, ...]
    history: np.ndarray
    samples: Samples
    structure: Structure


def views_of(observations: Views) -> tuple[list[np.ndarray], list[int]]:
    """Views (N, d_j) of all frames, and the lengths of the sequences they are made of."""
    observations = list(observations)
    if observations and all(isinstance(o, Demonstration) for o in observations):
        counts = {len(demonstration.frames) for demonstration in observations}
        dims = {tuple(v.shape[1] for v in d.observations) for d in observations}
        if len(dims) != 1 or counts == {0}:
            raise ArgumentError(
                f"the demonstrations have views of dimensions {sorted(dims)}; all need the same "
                "frames, at least one"
            )
        views = [
            np.concatenate(view)
            for view in zip(*(d.observations for d in observations), strict=True)
        ]
        return views, [len(demonstration) for demonstration in observations]
    views = [finite_array("observations", view) for view in observations]
    shapes = [view.shape for view in views]
    if not views or any(len(s) != 2 or 0 in s or s[0] != shapes[0][0] for s in shapes):
        raise ArgumentError(
            f"observations have shapes {shapes}; give demonstrations, or one (N, d_j) array per "
            "frame with the same N >= 1"
        )
    return views, [len(views[0])]


def fit(
    views: Sequence[np.ndarray],
    lengths: Sequence[int],
    components: int,
    *,
    covariance: str | Structure,
    start: Start,
    ridge: float | None,
    tolerance: float,
    max_iterations: int,
    restarts: int,
    time: ArrayLike | None,
    rng: np.random.Generator | None,
) -> Fit:
    """Fit a mixture to samples seen from P frames, ``views`` (N, d_j) each.

    ``lengths`` are those of the sequences that the samples are made of, one after the other; the
    other arguments are those of :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.
    """
    structure = structure_of(covariance)
    _check_options(components, tolerance, max_iterations, restarts)
    _check_samples(views, components)
    samples = Samples(views)
    limits = regularisation(samples, ridge)
    best = None
    for labels in _starts(start, views, lengths, components, restarts, time, rng):
        if isinstance(labels, tuple):
            mixture = project(_given(labels, components, samples), structure, limits)
        else:
            one_hot = (labels[:, None] == np.arange(components)).astype(float)
            mixture = maximise(samples.moments(one_hot), None, structure, limits)
        found = em(samples, mixture, structure, limits, tolerance, max_iterations)
        if best is None or found[1][-1] > best[1][-1]:
            best = found
    mixture, history = best
    return Fit(mixture.priors, mixture.frames(samples), history, samples, structure)


def _starts(start, views, lengths, components, restarts, time, rng) -> Iterator:
    """Labels (N,) to begin with, or a model."""
    if isinstance(start, tuple):
        yield start
        return
    if start not in (None, "time", "kmeans"):
        raise ArgumentError(f"start is {start!r}; give 'time', 'kmeans', a model, or None")
    if components == 1:
        yield np.zeros(len(views[0]), int)
        return
    if start != "kmeans":
        yield split_in_time(time_of(views, lengths, time), components)
    if start != "time":
        points = standardised(views)
        rng = np.random.default_rng(0) if rng is None else rng
        for _ in range(1 + restarts):
            yield kmeans(points, spread_centres(points, components, rng))[0]


def _given(model, components: int, samples: Samples) -> Mixture:
    priors, frames = model
    shapes = [frame.mean.shape for frame in frames]
    dims = dict(
        (j, d) for group, d in zip(samples.groups, samples.dims, strict=True) for j in group
    )
    expected = [(components, dims[j]) for j in range(len(dims))]
    if shapes != expected:
        raise ArgumentError(f"start has means of shapes {shapes}; the data ask for {expected}")
    return Mixture.of(np.maximum(priors, np.finfo(float).tiny), frames, samples)


def _check_options(components, tolerance, max_iterations, restarts) -> None:
    for name, value, least in (
        ("components", components, 1),
        ("max_iterations", max_iterations, 0),
        ("restarts", restarts, 0),
    ):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise ArgumentError(f"{name} is {value!r}; it must be a whole number >= {least}")
    if not isinstance(tolerance, int | float | np.number) or np.isnan(tolerance):
        raise ArgumentError(f"tolerance is {tolerance!r}; it must be a number")


def _check_samples(views: Sequence[np.ndarray], components: int) -> None:
    count = len(views[0])
    if count < 2:
        raise ArgumentError(f"{count} sample was given; a Gaussian needs at least 2")
    distinct = _distinct(np.hstack([view[: 4 * components] for view in views]))
    if distinct < components:
        distinct = _distinct(np.hstack(views))
    if distinct < components:
        raise ArgumentError(
            f"components is {components}, but only {distinct} samples differ; ask for at most "
            f"{distinct} components"
        )


def _distinct(points: np.ndarray) -> int:
    return len(np.unique(points, axis=0))
