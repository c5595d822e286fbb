"""Unit, origin and clock of the data: x -> s x + c and t -> s t + c change nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpsim import (
    Demonstration,
    Frame,
    Motion,
    attractor_path,
    fit_gmm,
    fit_gp,
    fit_gp_gmm,
    fit_promp,
    fit_tp_promp,
    fit_tp_trajectory_distribution,
    fit_trajectory_distribution,
    lwr,
)

SCALES = st.floats(-3, 3).map(lambda x: 10.0**x)
ORIGINS = st.floats(-1e6, 1e6)
CHANGES = given(s=SCALES, c=ORIGINS, r=SCALES, d=ORIGINS)
"""x -> s (x + c) in space, t -> r (t + d) in time; both have a spread of about one."""

FEW = settings(max_examples=6, deadline=None)
WITHIN = 1e-6
T = np.linspace(0, 1, 40)


def paths(count=6, seed=0):
    rng = np.random.default_rng(seed)
    return np.array(
        [
            np.column_stack([T + 0.1 * rng.normal(), np.sin(4 * T + 0.1 * rng.normal())])
            + 0.01 * rng.normal(size=(len(T), 2))
            for _ in range(count)
        ]
    )


def demonstrations(s=1.0, c=0.0, r=1.0, d=0.0):
    rng, found = np.random.default_rng(1), paths()
    return [
        Demonstration(
            r * (T + d),
            s * (x + c),
            [
                Frame(np.eye(2), s * (rng.normal(size=2) + c)),
                Frame([[0.6, -0.8], [0.8, 0.6]], s * (rng.normal(size=2) + c)),
            ],
        )
        for x in found
    ]


def same(found, expected, s, c, within=WITHIN):
    np.testing.assert_allclose(found.mean / s - c, expected.mean, atol=within)
    np.testing.assert_allclose(
        found.covariance / s**2,
        expected.covariance,
        atol=within * np.abs(expected.covariance).max(),
    )


@FEW
@CHANGES
@pytest.mark.parametrize(
    "fit",
    [
        lambda paths: fit_trajectory_distribution(paths, 2),
        lambda paths: fit_promp(list(paths), 8).distribution(20),
        lambda paths: fit_promp([paths[0]], 8).distribution(20),
    ],
)
def test_distributions_and_what_passes_a_point(fit, s, c, r, d):
    expected, found = fit(paths()), fit(s * (paths() + c))
    same(found.marginal(), expected.marginal(), s, c)
    to = expected.mean[10] + [0.05, -0.03]
    same(found.through(10, s * (to + c)).marginal(), expected.through(10, to).marginal(), s, c)


@FEW
@CHANGES
@pytest.mark.parametrize(
    "fit",
    [
        lambda some: fit_tp_trajectory_distribution(some, 2),
        lambda some: fit_tp_promp(some, 6),
    ],
)
def test_what_frames_see(fit, s, c, r, d):
    new = [Frame(np.eye(2), [0.3, 0.1]), Frame([[0.6, -0.8], [0.8, 0.6]], [-0.2, 0.4])]
    moved = [Frame(frame.A, s * (frame.b + c)) for frame in new]
    expected, found = fit(demonstrations()).adapt(new), fit(demonstrations(s, c, r, d)).adapt(moved)
    if hasattr(expected, "distribution"):
        expected, found = expected.distribution(20), found.distribution(20)
    same(found.marginal(), expected.marginal(), s, c, 1e-5)


@FEW
@CHANGES
def test_lwr(s, c, r, d):
    y = np.concatenate(list(paths()))
    t, queries = np.tile(T, 6), np.linspace(0, 1, 7)
    expected = lwr(t, y, queries, 0.05)
    found = lwr(r * (t + d), s * (y + c), r * (queries + d), 0.05 * r)
    same(found, expected, s, c, 1e-5)


@FEW
@CHANGES
def test_gaussian_process_and_its_spread(s, c, r, d):
    y = paths()[0] * [1.0, 1000.0]
    queries = np.linspace(0.05, 0.95, 7)
    expected, found = fit_gp(T, y), fit_gp(r * (T + d), s * (y + c * np.array([1.0, 1000.0])))
    units = np.array([1.0, 1000.0])
    for one, other in (
        (expected(queries), found(r * (queries + d))),
        (expected.spread(queries), found.spread(r * (queries + d))),
    ):
        np.testing.assert_allclose(other.mean / s / units - c, one.mean / units, atol=1e-3)
        np.testing.assert_allclose(
            np.sqrt(np.diagonal(other.covariance, axis1=1, axis2=2)) / s,
            np.sqrt(np.diagonal(one.covariance, axis1=1, axis2=2)),
            rtol=1e-2,
        )


@FEW
@CHANGES
@pytest.mark.parametrize("encoding", ["logarithm", "entries"])
def test_mixtures_predicted_by_a_process(encoding, s, c, r, d):
    tasks = np.array([[0.0], [0.4], [1.0]])
    data = [paths(1, seed)[0] + 0.3 * task for seed, task in enumerate(tasks)]

    def predicted(some, where, new):
        gmms = [fit_gmm(x, 2, start="time") for x in some]
        return fit_gp_gmm(where, gmms, encoding=encoding)(new).gaussians

    expected = predicted(data, tasks, [0.6])
    found = predicted([s * (x + c) for x in data], r * (tasks + d), [r * (0.6 + d)])
    same(found, expected, s, c, 1e-2)


@FEW
@CHANGES
def test_attractors(s, c, r, d):
    x = paths()[0]
    expected = attractor_path(Motion.of(x, T), 100.0, 20.0)
    found = attractor_path(Motion.of(s * (x + c), r * (T + d)), 100.0 / r**2, 20.0 / r)
    np.testing.assert_allclose(found / s - c, expected, atol=1e-4)
