"""Learning on: new demonstrations for a TP-GMM whose old data are gone (Sections 3 and 9)."""

from collections.abc import Iterator

import numpy as np

from tpsim.checks import bound, instance, number, whole
from tpsim.errors import ArgumentError
from tpsim.learning.em import Limits, Mixture, likeliest, maximise, project, regularisation
from tpsim.learning.fit import Views, seen_by_frames
from tpsim.learning.moments import Memory
from tpsim.learning.start import clusters, split_in_time
from tpsim.learning.statistics import Components, Samples
from tpsim.learning.tp_gmm import TPGMM

WIDER = 0.01  # of the covariance of all samples, added to every component of a start


def update_tp_gmm(
    model: TPGMM,
    demonstrations: Views,
    *,
    retention: float = 1.0,
    ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
) -> TPGMM:
    """Learn new demonstrations without the old ones.

    A model remembers the moments of short runs of its samples, at most 1024 of them however many
    demonstrations there were. Log densities are linear in those moments, so EM runs on new
    samples and memory together, from the model as it is, and no sample is lost: one run only
    shares its responsibilities.

    Parameters
    ----------
    model : TPGMM
        As :func:`tpsim.learning.tp_gmm.fit_tp_gmm` or an earlier update gave it.
    demonstrations : sequence of Demonstration, or of P arrays (N, d_j)
        New data, seen from the same frames; rows in the order of time.
    retention : float
        What an old sample counts against a new one, above 0; less than 1 forgets.
    ridge : float, optional
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.
    tolerance : float
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.
    max_iterations : int
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.

    Returns
    -------
    TPGMM
        Of the same number of components and the same covariance structure. ``history`` is the
        mean log-likelihood of new samples and memory.

    Raises
    ------
    ArgumentError
        A model without memory, or views that do not fit it.
    """
    seen = seen_by_frames(demonstrations)
    retention = number("retention", retention, above=0)
    bound("tolerance", tolerance)
    max_iterations = whole("max_iterations", max_iterations)
    samples = Samples(seen.views, _memory_of(model, seen.views).times(retention))
    memory = samples.remembered(seen.time(), seen.lengths)
    starts = _starts(model, samples, memory, ridge)
    mixture, history = likeliest(samples, starts, model.structure, tolerance, max_iterations)
    count = round(memory.moments.weight.sum())
    return TPGMM(mixture.priors, mixture.frames(samples), history, count, model.structure, memory)


def _starts(
    model: TPGMM, samples: Samples, memory: Memory, ridge: float | None
) -> Iterator[tuple[Mixture, Limits]]:
    """Begin from the model, from the model grown wider, and anew as a first fit does.

    What was learned from few demonstrations is narrower than what the next ones show.
    """
    current = Mixture.of(np.maximum(model.priors, 1e-300), model.frames, samples)
    _, parts = samples.expectation(current.priors, current.components)
    limits = regularisation(samples, ridge, parts)
    total = samples.total().scatter
    for share in (0.0, WIDER):
        components = tuple(
            Components(part.mean, part.covariance + share * all_)
            for part, all_ in zip(current.components, total, strict=True)
        )
        yield project(Mixture(current.priors, components), model.structure, limits), limits
    for labels in _labellings(memory, model.components):
        moments = memory.moments.pooled(labels, model.components)
        limits = regularisation(samples, ridge, moments)
        yield maximise(moments, None, model.structure, limits), limits


def _labellings(memory: Memory, components: int) -> Iterator[np.ndarray]:
    """Share the remembered runs out among the components, in time and by k-means."""
    yield split_in_time(memory.time, components)
    views = [mean for part in memory.moments.mean for mean in part]
    yield clusters(views, components, np.random.default_rng(0))


def _memory_of(model: TPGMM, views: list[np.ndarray]) -> Memory:
    """What the model remembers, after comparing the new data with it."""
    memory = instance("model", model, TPGMM).memory
    if memory is None:
        raise ArgumentError("the model has no memory of its samples; fit it with fit_tp_gmm")
    dims = tuple(view.shape[1] for view in views)
    if dims != model.dims:
        raise ArgumentError(
            f"the new demonstrations have views of dimensions {dims}; the model's frames have "
            f"{model.dims}"
        )
    return memory
