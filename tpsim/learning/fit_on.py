"""Fit of mixtures on manifolds: first in one tangent space, then in that of each mean."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tpsim.checks import generator, number, several, whole
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.em import Limits, project
from tpsim.learning.fit import Options, Seen, check_samples, fit, labellings
from tpsim.learning.riemannian_em import TangentSamples
from tpsim.learning.subspace import Structure, structure_of
from tpsim.learning.tangents import Charted
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold

WIDE = 2.5
"""Angle [rad] from the mean of all samples beyond which one tangent space no longer holds them."""


@dataclass(frozen=True, eq=False)
class FitOn:
    """What EM found: the fields that GMM and TP-GMM share."""

    priors: np.ndarray
    frames: tuple[RiemannianGaussian, ...]
    history: np.ndarray
    samples: TangentSamples
    structure: Structure
    hidden: Sequence[tuple[int, int]] = ()


def fit_on(
    manifold: Manifold | Sequence[Manifold], seen: Seen, components: int, options: Options
) -> FitOn:
    """Fit a mixture to samples seen from P frames, all on one manifold or each on its own.

    In R^n it is :func:`~.fit.fit`. Elsewhere samples that one tangent space holds begin with the
    model that it finds there.
    """
    samples = samples_on(manifold, seen)
    if all(one.flat for one in samples.of_frames) and not isinstance(options.start, tuple):
        plain = fit(seen, components, options)
        return FitOn(
            plain.priors,
            tuple(map(_on, samples.of_frames, plain.frames)),
            plain.history,
            samples,
            plain.structure,
            plain.hidden,
        )
    structure = structure_of(options.covariance)
    components = whole("components", components, least=1)
    generator("rng", options.rng, 0)
    check_samples(seen.views, components)
    found = []
    for start, limits in _starts(samples, seen, components, options, structure):
        try:
            found.append(
                samples.em(start, structure, limits, options.tolerance, options.max_iterations)
            )
        except (np.linalg.LinAlgError, FloatingPointError) as error:
            raise ArgumentError(
                f"EM met a singular covariance ({error}); give a larger ridge, or None for the "
                "floor that the data set"
            ) from error
    model, history = max(found, key=lambda result: result[1][-1])
    frames = samples.gaussians(model)
    for frame in frames:
        _ = frame.precision
    hidden = samples.hidden(model)
    return FitOn(model.mixture.priors, frames, history, samples, structure, hidden)


def _on(manifold: Manifold, gaussian: Gaussian) -> RiemannianGaussian:
    return RiemannianGaussian.trusted_on(manifold, gaussian.mean, gaussian.covariance)


def samples_on(manifold: Manifold | Sequence[Manifold], seen: Seen) -> TangentSamples:
    """Samples as points of the manifolds, or an ArgumentError where these do not fit."""
    manifolds = several("manifold", manifold, Manifold, "such as R(3) * S3")
    if len(manifolds) == 1:
        manifolds = manifolds * len(seen.views)
    if len(manifolds) != len(seen.views):
        raise ArgumentError(
            f"{len(manifolds)} manifolds were given for {len(seen.views)} frames; give one for "
            "all, or one for each"
        )
    views = [
        m.points(f"observations[{j}]", v)
        for j, (m, v) in enumerate(zip(manifolds, seen.views, strict=True))
    ]
    return TangentSamples(manifolds, views, seen.observed)


def _starts(
    samples: TangentSamples,
    seen: Seen,
    components: int,
    options: Options,
    structure: Structure,
) -> Iterator[tuple[Charted, Limits]]:
    ridge = None if options.ridge is None else number("ridge", options.ridge, least=0)
    if isinstance(options.start, tuple):
        yield begun(
            samples, samples.charted(*_given(options.start, samples, components)), structure, ridge
        )
        return
    views = samples.in_tangent_spaces()
    if samples.farthest(views) < WIDE:
        chart = fit(replace(seen, views=views), components, options)
        yield begun(samples, samples.placed(chart.priors, chart.frames), structure, ridge)
        return
    # Signs of quaternions and whole turns agree in the tangent spaces, if nothing else does.
    for labels in labellings(views, seen.time(options.time), components, options):
        one_hot = (labels[:, None] == np.arange(components)).astype(float)
        yield samples.begin(one_hot, structure, ridge)


def begun(
    samples: TangentSamples, model: Charted, structure: Structure, ridge: float | None
) -> tuple[Charted, Limits]:
    """Begin from a model: its floors are set by the samples that it claims."""
    if ridge is None:
        _, parts = samples.expectation(model)
        limits = samples.floors(parts, model.bases)
    else:
        limits = samples.ridges(ridge)
    mixture = project(model.mixture, structure, limits)
    for old, new in zip(model.mixture.components, mixture.components, strict=True):
        if new.factors is not None or not np.array_equal(old.covariance, new.covariance):
            return Charted(mixture, model.bases), limits
    return model, limits


def _given(
    model: tuple[np.ndarray, Sequence[Gaussian]], samples: TangentSamples, components: int
) -> tuple[np.ndarray, Sequence[RiemannianGaussian]]:
    priors, frames = model
    given = [getattr(frame, "manifold", None) for frame in frames]
    shapes = [frame.mean.shape[0] for frame in frames]
    if given != list(samples.of_frames) or set(shapes) != {components}:
        raise ArgumentError(
            f"start has {shapes} components on {', '.join(map(str, given))}; the data ask for "
            f"{components} on {', '.join(map(str, samples.of_frames))}"
        )
    return priors, [frame for frame in frames if isinstance(frame, RiemannianGaussian)]
