import numpy as np
import pytest

from tpsim import TPGMM, Gaussian, fit_tp_gmm, shrink_directions
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations
from tpsim.learning.shrinkage import oracle_weight


def a_model(dim=5, K=3, seed=0):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(K, dim, dim))
    covariance = root @ root.mT + 0.1 * np.eye(dim)
    return TPGMM(np.full(K, 1 / K), (Gaussian(rng.normal(size=(K, dim)), covariance),))


def conditional(model, given=(0,)):
    gaussian = model.frames[0]
    return gaussian.condition(gaussian.mean[..., list(given)], given)


def test_weight_of_few_samples_is_close_to_the_best():
    """Close to the best constant weight, which takes the truth to know."""
    rng, truth, n = np.random.default_rng(0), np.diag([1.0, 0.3]), 4
    x = rng.multivariate_normal([0, 0], truth, size=(4000, n))
    S = np.einsum("mni,mnj->mij", x, x) / n
    target = np.trace(S, axis1=1, axis2=2)[:, None, None] / 2 * np.eye(2)

    def error(rho):
        return (((1 - rho) * S + rho * target - truth) ** 2).sum((1, 2)).mean()

    best = min(error(rho) for rho in np.linspace(0, 1, 51))
    ours = error(oracle_weight(S, n)[:, None, None])
    assert ours < 0.7 * error(0.0)
    assert ours < 1.15 * best


def test_weight_falls_with_the_number_of_demonstrations():
    line = np.diag([1.0, 0.0])
    np.testing.assert_allclose([oracle_weight(line, n) for n in (1, 2, 4, 8)], [1, 1, 0.5, 0.25])
    assert oracle_weight(np.eye(3), 1000) == 1


def test_size_slopes_and_inputs_stay():
    model = a_model(3)
    shrunk = shrink_directions(model, 2)
    S, ours = conditional(model).covariance, conditional(shrunk).covariance
    np.testing.assert_allclose(np.trace(S, axis1=1, axis2=2), np.trace(ours, axis1=1, axis2=2))
    at = model.frames[0].mean[:, :1] + 0.3
    before, after = model.frames[0].condition(at, [0]), shrunk.frames[0].condition(at, [0])
    np.testing.assert_allclose(before.mean, after.mean)
    np.testing.assert_array_equal(
        model.frames[0].covariance[:, 0, 0], shrunk.frames[0].covariance[:, 0, 0]
    )
    assert (np.linalg.cond(ours) <= np.linalg.cond(S)).all()


def test_one_demonstration_leaves_equal_spread_and_the_tie_to_velocity():
    shrunk = shrink_directions(a_model(5), 1, blocks=2)
    parted = conditional(shrunk).covariance.reshape(3, 2, 2, 2, 2)
    for direction in range(2):
        np.testing.assert_allclose(
            parted[:, :, direction, :, direction], parted[:, :, 0, :, 0], atol=1e-12
        )
    np.testing.assert_allclose(parted[:, :, 0, :, 1], 0, atol=1e-12)
    assert np.abs(parted[:, 0, 0, 1, 0]).max() > 0.1


def test_follows_rotations_and_units():
    model = a_model(5)
    c, s = np.cos(0.4), np.sin(0.4)
    change = np.eye(5)
    change[1:3, 1:3] = [[c, -s], [s, c]]
    change[3:, 3:] = 7 * change[1:3, 1:3]
    moved = TPGMM(model.priors, (model.frames[0].affine(change),))
    ours = shrink_directions(moved, 4, blocks=2).frames[0].covariance
    expected = shrink_directions(model, 4, blocks=2).frames[0].affine(change).covariance
    np.testing.assert_allclose(ours, expected, atol=1e-10)


def test_without_inputs():
    shrunk = shrink_directions(a_model(4), 1, given=(), blocks=2)
    covariance = shrunk.frames[0].covariance
    np.testing.assert_allclose(covariance[:, 0, 0], covariance[:, 1, 1])
    np.testing.assert_allclose(covariance[:, 0, 1], 0, atol=1e-12)


def test_two_demonstrations_no_longer_contradict_each_other():
    """Their covariance is almost a line; its product over frames is where no one ever was."""
    timed = [d.with_time() for d in u_demonstrations(2, 60)]
    model = fit_tp_gmm(timed, 6, start="time")
    worst = [
        np.linalg.cond(m.frames[1].condition(m.frames[1].mean[:, :1], [0]).covariance).max()
        for m in (model, shrink_directions(model, 2))
    ]
    assert worst[0] > 50
    assert worst[1] < 1.001


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"demonstrations": 0}, "demonstrations is 0"),
        ({"demonstrations": 2, "given": (9,)}, "needs inputs out of 0..4"),
        ({"demonstrations": 2, "blocks": 3}, "equal blocks"),
        ({"demonstrations": 2, "blocks": 0}, "blocks is 0"),
    ],
)
def test_bad_arguments(options, words):
    with pytest.raises(ArgumentError, match=words):
        shrink_directions(a_model(5), **options)
