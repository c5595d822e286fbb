from pathlib import Path

import numpy as np
import pytest

from tpsim import PlanarChain, two_armed
from tpsim.control.planar import numeric_jacobian
from tpsim.control.projection import nullspace, pseudoinverse
from tpsim.errors import ArgumentError

FIGURES = np.load(Path(__file__).parents[1] / "reference" / "planar.npz")


@pytest.mark.parametrize("arm", ["fk3", "fk5"])
@pytest.mark.parametrize("i", range(6))
def test_reference_figures(arm, i):
    """Six postures of two arms; the last is q = 0, which is singular.

    The reference's damping adds 1e-8 to J J' everywhere; ours leaves regular postures alone.
    """
    q, lengths = FIGURES[f"{arm}_q"][i], FIGURES[f"{arm}_a"][i]
    chain = PlanarChain(lengths)
    J = chain.jacobian(q)
    turns = (chain.orientation(q) - FIGURES[f"{arm}_theta"][i]) / (2 * np.pi)
    assert turns == pytest.approx(np.round(turns), abs=1e-12)
    for ours, name, tolerance in (
        (chain.position(q), "x", 1e-12),
        (J, "J", 1e-12),
        (chain.orientation_jacobian(q)[0], "Jrot", 1e-12),
        (pseudoinverse(J), "pinvJ", 1e-10),
        (J.T @ np.linalg.inv(J @ J.T + 1e-8 * np.eye(2)), "pinvJ_damped", 1e-6),
        (nullspace(J), "N", 1e-10),
    ):
        theirs = FIGURES[f"{arm}_{name}"][i]
        scale = max(1.0, np.abs(theirs).max())
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * scale, err_msg=name)


@pytest.mark.parametrize(
    "chain",
    [PlanarChain((0.6, 0.5, 0.4)), PlanarChain((0.3, 0.2), joints=(2, 0), size=4)],
    ids=["serial", "scattered joints"],
)
def test_analytic_jacobians_are_the_numeric_ones(chain):
    q = np.random.default_rng(0).normal(size=chain.size)
    for function, J in (
        (chain.position, chain.jacobian),
        (chain.orientation, chain.orientation_jacobian),
    ):
        np.testing.assert_allclose(numeric_jacobian(function, q), J(q), atol=1e-9)


def test_two_arms_share_the_trunk_alone():
    left, right = two_armed((0.6, 0.5, 0.4, 0.5, 0.4))
    q = np.array([1.2, 0.7, 0.3, -0.7, -0.3])
    np.testing.assert_array_equal(left.points(q)[1], right.points(q)[1])
    np.testing.assert_array_equal(left.jacobian(q)[:, 3:], 0.0)
    np.testing.assert_array_equal(right.jacobian(q)[:, 1:3], 0.0)
    mirrored = q * [-1, 1, 1, 1, 1] + [np.pi, 0, 0, 0, 0]
    np.testing.assert_allclose(
        right.position(mirrored), left.position(q)[[0, 1]] * [-1, 1], atol=1e-12
    )


def test_postures_broadcast_over_time():
    chain = PlanarChain((0.3, 0.2, 0.1))
    q = np.random.default_rng(1).normal(size=(7, 3))
    assert chain.points(q).shape == (7, 4, 2)
    np.testing.assert_array_equal(chain.jacobian(q)[4], chain.jacobian(q[4]))
    np.testing.assert_allclose(chain.points(q)[:, -1], chain.position(q))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PlanarChain(()), "one joint per link"),
        (lambda: PlanarChain((1.0, 1.0), joints=(0, 0)), "one joint per link"),
        (lambda: PlanarChain((1.0, -1.0)), "positive"),
        (lambda: PlanarChain((1.0,), joints=(3,), size=2), "between 0"),
        (lambda: PlanarChain((1.0, 1.0)).position([0.0]), "q has shape"),
        (lambda: two_armed((1.0, 1.0)), "5 links"),
    ],
)
def test_bad_input_is_refused(make, message):
    with pytest.raises(ArgumentError, match=message):
        make()
