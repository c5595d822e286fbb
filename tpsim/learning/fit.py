"""From samples and options to a fitted mixture: checks at the border, starts, and the best."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.agreement import agreed_with_warning
from tpsim.arrays import array_of
from tpsim.checks import (
    Seed,
    bound,
    choice,
    entries,
    finite_array,
    generator,
    is_table,
    several,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.em import Limits, Mixture, likeliest, maximise, project, regularisation
from tpsim.learning.hidden import PartlySeen, filled, observed_of, too_little_seen
from tpsim.learning.start import clusters, split_in_time, time_of
from tpsim.learning.statistics import Samples
from tpsim.learning.subspace import Structure, structure_of

Start = str | tuple[np.ndarray, Sequence[Gaussian]] | None
"""``"time"``, ``"kmeans"``, priors and Gaussians of a model, or None for the best of both."""

Views = Demonstration | Sequence[Demonstration] | Sequence[ArrayLike]
"""Demonstrations, or what each of P frames saw, (N, d_j)."""

MANY = 50_000  # samples from which on EM first looks for its start among a share of them
FEW = 10_000  # samples in that share


@dataclass(frozen=True, eq=False)
class Fit:
    """What EM found: the fields that GMM and TP-GMM share."""

    priors: np.ndarray
    frames: tuple[Gaussian, ...]
    history: np.ndarray
    samples: Samples
    structure: Structure
    time: np.ndarray
    hidden: Sequence[tuple[int, int]] = ()


@dataclass(frozen=True, eq=False)
class Seen:
    """What all frames saw: views (N, d_j), of sequences one after the other, and their stamps.

    And, where not all frames saw all samples, which they did, (N, P).
    """

    views: list[np.ndarray]
    lengths: list[int]
    stamps: list[np.ndarray] | None = None
    observed: np.ndarray | None = None

    def samples(self, rows: slice = slice(None)) -> Samples:
        """All samples or some, ready for EM."""
        views = self.views if rows == slice(None) else [view[rows] for view in self.views]
        return Samples(views) if self.observed is None else PartlySeen(views, self.observed[rows])

    def time(self, given: ArrayLike | None = None) -> np.ndarray:
        """Time of every sample, from 0 to 1, (N,)."""
        return time_of(self.views, self.lengths, given, self.stamps)


def demonstrations_of(name: str, observations: object) -> list[Demonstration] | None:
    """Demonstrations, one or many, in agreement about signs and turns; None for anything else."""
    if isinstance(observations, Demonstration):
        observations = [observations]
    if not isinstance(observations, Sequence) or isinstance(observations, str | bytes | memoryview):
        return None
    given = [isinstance(one, Demonstration) for one in observations]
    if not any(given):
        return None
    return agreed_with_warning(several(name, observations, Demonstration))


def seen_by_frames(observations: object, observed: object = None) -> Seen:
    """Views (N, d_j) of all frames, from demonstrations or from one array per frame.

    ``observed`` says which samples they saw, see :func:`~.hidden.observed_of`.
    """
    demonstrations = demonstrations_of("demonstrations", observations)
    if demonstrations is not None:
        dims = [tuple(v.shape[1] for v in d.observations) for d in demonstrations]
        if len(set(dims)) != 1 or not dims[0]:
            odd = next((m for m, d in enumerate(dims) if d != dims[0] or not d), 0)
            raise ArgumentError(
                f"demonstration {odd} has views of dimensions {dims[odd]}, the first one "
                f"{dims[0]}; all need the same frames or observations, at least one"
            )
        views = [
            np.concatenate(view)
            for view in zip(*(d.observations for d in demonstrations), strict=True)
        ]
        lengths = [len(d) for d in demonstrations]
        mask = observed_of(observed, lengths, len(views))
        return Seen(filled(views, mask), lengths, [d.time for d in demonstrations], mask)
    given: Sequence[object] = entries("observations", observations)
    mask = None
    if observed is not None and given:
        arrays = [
            view if isinstance(view, np.ma.MaskedArray) else array_of(f"observations[{j}]", view)
            for j, view in enumerate(given)
        ]
        if all(array.ndim == 2 for array in arrays):
            mask = observed_of(observed, [len(arrays[0])], len(arrays))
            given = filled(arrays, mask)
    views = [finite_array(f"observations[{j}]", view) for j, view in enumerate(given)]
    shapes = [view.shape for view in views]
    if not views or any(len(s) != 2 or 0 in s or s[0] != shapes[0][0] for s in shapes):
        raise ArgumentError(
            f"observations have shapes {shapes}; give demonstrations, or one (N, d_j) array per "
            "frame with the same N >= 1"
        )
    return Seen(views, [len(views[0])], None, mask)


def seen_as_data(sequences: object) -> Seen:
    """Samples (N, D) of one or more sequences (T_m, D), or of the data of demonstrations."""
    demonstrations = demonstrations_of("data", sequences)
    if demonstrations is not None:
        arrays = [d.data for d in demonstrations]
    elif is_table("data", sequences):
        arrays = [finite_array("data", sequences)]
    else:
        arrays = [
            finite_array(f"data[{m}]", one) for m, one in enumerate(entries("data", sequences))
        ]
        if arrays and all(one.ndim == 1 for one in arrays):
            arrays = [finite_array("data", sequences)]
    shapes = [one.shape for one in arrays]
    if not arrays or any(len(s) != 2 or 0 in s or s[1] != shapes[0][1] for s in shapes):
        raise ArgumentError(
            f"data has shapes {shapes}; give (N, D), or sequences (T_m, D) of one D, none empty"
        )
    stamps = None if demonstrations is None else [d.time for d in demonstrations]
    return Seen([np.concatenate(arrays)], [len(one) for one in arrays], stamps)


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
    rng: Seed

    def __post_init__(self) -> None:
        for name, value in (
            ("max_iterations", whole("max_iterations", self.max_iterations)),
            ("restarts", whole("restarts", self.restarts)),
            ("tolerance", bound("tolerance", self.tolerance)),
        ):
            object.__setattr__(self, name, value)
        if isinstance(self.start, str):
            choice("start", self.start, ("time", "kmeans"))
        elif self.start is not None and not (
            isinstance(self.start, tuple) and len(self.start) == 2
        ):
            raise ArgumentError(
                f"start is a {type(self.start).__name__}; give 'time', 'kmeans', a model of the "
                "same kind, or None for the best"
            )


def fit(seen: Seen, components: int, options: Options) -> Fit:
    """Fit a mixture to samples seen from P frames."""
    structure = structure_of(options.covariance)
    components = whole("components", components, least=1)
    generator("rng", options.rng, 0)
    check_samples(seen.views, components)
    time = seen.time(options.time)
    samples = seen.samples()
    if samples.count <= MANY or isinstance(options.start, tuple):
        starts = _starts(samples, seen.views, time, components, options)
    else:
        # What many samples say about where to start, a share of them says as well.
        rows = slice(None, None, -(-samples.count // FEW))
        few = [view[rows] for view in seen.views]
        thin = seen.samples(rows)
        best, _ = likeliest(
            thin,
            _starts(thin, few, time[rows], components, options),
            structure,
            options.tolerance,
            options.max_iterations,
        )
        starts = iter([_begun(best, samples, structure, options)])
    mixture, history = likeliest(
        samples, starts, structure, options.tolerance, options.max_iterations
    )
    hidden = []
    if seen.observed is not None:
        _, moments = samples.expectation(mixture.priors, mixture.components)
        hidden = too_little_seen(moments, samples.groups)
    frames = mixture.frames(samples)
    for frame in frames:
        _ = frame.precision  # computed once, remembered, and refused here if it means nothing
    return Fit(mixture.priors, frames, history, samples, structure, time, hidden)


def _starts(
    samples: Samples,
    views: Sequence[np.ndarray],
    time: np.ndarray,
    components: int,
    options: Options,
) -> Iterator[tuple[Mixture, Limits]]:
    """Mixtures to begin with: the model that was given, or one from each labelling."""
    structure = structure_of(options.covariance)
    if isinstance(options.start, tuple):
        yield _begun(_given(options.start, components, samples), samples, structure, options)
        return
    for labels in labellings(views, time, components, options):
        one_hot = (labels[:, None] == np.arange(components)).astype(float)
        parts = samples.moments(one_hot)
        limits = regularisation(samples, options.ridge, parts)
        yield maximise(parts, None, structure, limits), limits


def _begun(
    mixture: Mixture, samples: Samples, structure: Structure, options: Options
) -> tuple[Mixture, Limits]:
    """Begin from a mixture: its floors are set by the samples that it claims."""
    _, parts = samples.expectation(mixture.priors, mixture.components)
    limits = regularisation(samples, options.ridge, parts)
    return project(mixture, structure, limits), limits


def labellings(
    views: Sequence[np.ndarray], time: np.ndarray, components: int, options: Options
) -> Iterator[np.ndarray]:
    """Labels (N,) that share the samples out among the components."""
    if components == 1:
        yield np.zeros(len(views[0]), int)
        return
    if options.start != "kmeans":
        yield split_in_time(time, components)
    if options.start != "time":
        rng = generator("rng", options.rng, 0)
        for _ in range(1 + options.restarts):
            yield clusters(views, components, rng)


def _given(
    model: tuple[np.ndarray, Sequence[Gaussian]], components: int, samples: Samples
) -> Mixture:
    priors, frames = model
    dims = {j: d for group, d in zip(samples.groups, samples.dims, strict=True) for j in group}
    shapes = [frame.mean.shape for frame in frames]
    expected = [(components, dims[j]) for j in range(len(dims))]
    if shapes != expected:
        raise ArgumentError(f"start has means of shapes {shapes}; the data ask for {expected}")
    return Mixture.of(np.maximum(priors, np.finfo(float).tiny), frames, samples)


def check_samples(views: Sequence[np.ndarray], components: int) -> None:
    """Raise an ArgumentError where too few samples differ for so many components."""
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
