"""From samples and options to a fitted mixture: checks at the border, starts, and the best."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, finite_array
from tpsim.learning.em import Mixture, likeliest, maximise, project, regularisation
from tpsim.learning.start import clusters, split_in_time, time_of
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
        counts = {len(demonstration.observations) for demonstration in observations}
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


@dataclass(frozen=True, eq=False)
class Options:
    """How to fit, in the words of :func:`tpsim.learning.tp_gmm.fit_tp_gmm`."""

    covariance: str | Structure
    start: Start
    ridge: float | None
    tolerance: float
    max_iterations: int
    restarts: int
    time: ArrayLike | None
    rng: np.random.Generator | None

    def __post_init__(self):
        checked_count("max_iterations", self.max_iterations, least=0)
        checked_count("restarts", self.restarts, least=0)
        if not isinstance(self.tolerance, int | float | np.number) or np.isnan(self.tolerance):
            raise ArgumentError(f"tolerance is {self.tolerance!r}; it must be a number")
        if isinstance(self.start, str) and self.start not in ("time", "kmeans"):
            raise ArgumentError(
                f"start is {self.start!r}; give 'time', 'kmeans', a model, or None for the best"
            )


def fit(
    views: Sequence[np.ndarray], lengths: Sequence[int], components: int, options: Options
) -> Fit:
    """Fit a mixture to samples seen from P frames, ``views`` (N, d_j) each.

    ``lengths`` are those of the sequences that the samples are made of, one after the other.
    """
    structure = structure_of(options.covariance)
    checked_count("components", components, least=1)
    _check_samples(views, components)
    samples = Samples(views)
    limits = regularisation(samples, options.ridge)
    starts = _starts(samples, views, lengths, components, options, limits)
    mixture, history = likeliest(
        samples, starts, structure, limits, options.tolerance, options.max_iterations
    )
    frames = mixture.frames(samples)
    for frame in frames:
        _ = frame.precision  # computed once, remembered, and refused here if it means nothing
    return Fit(mixture.priors, frames, history, samples, structure)


def _starts(samples, views, lengths, components, options, limits) -> Iterator[Mixture]:
    """Mixtures to begin with: the model that was given, or one from each labelling."""
    structure = structure_of(options.covariance)
    if isinstance(options.start, tuple):
        yield project(_given(options.start, components, samples), structure, limits)
        return
    for labels in _labellings(views, lengths, components, options):
        one_hot = (labels[:, None] == np.arange(components)).astype(float)
        yield maximise(samples.moments(one_hot), None, structure, limits)


def _labellings(views, lengths, components, options) -> Iterator[np.ndarray]:
    """Labels (N,) that share the samples out among the components."""
    if components == 1:
        yield np.zeros(len(views[0]), int)
        return
    if options.start != "kmeans":
        yield split_in_time(time_of(views, lengths, options.time), components)
    if options.start != "time":
        rng = np.random.default_rng(0) if options.rng is None else options.rng
        for _ in range(1 + options.restarts):
            yield clusters(views, components, rng)


def _given(model, components: int, samples: Samples) -> Mixture:
    priors, frames = model
    dims = {j: d for group, d in zip(samples.groups, samples.dims, strict=True) for j in group}
    shapes = [frame.mean.shape for frame in frames]
    expected = [(components, dims[j]) for j in range(len(dims))]
    if shapes != expected:
        raise ArgumentError(f"start has means of shapes {shapes}; the data ask for {expected}")
    return Mixture.of(np.maximum(priors, np.finfo(float).tiny), frames, samples)


def checked_count(name: str, value: int, least: int) -> None:
    """Raise an ArgumentError unless ``value`` is a whole number from ``least`` upwards."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ArgumentError(f"{name} is {value!r}; it must be a whole number >= {least}")


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
