"""Orientations and angles from raw recordings: conventions, signs, turns, warnings."""

import warnings

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tpsim import DataWarning, Demonstration, Frame, agree, fit_tp_gmm, fit_tp_promp, gmr, rotation
from tpsim.errors import ArgumentError

T = np.linspace(0, 1, 60)
TURNS = Rotation.from_rotvec(np.outer(2.8 * T, [0.6, 0.0, 0.8]))
POSITIONS = np.column_stack([T, T**2, -T])


@pytest.mark.parametrize(
    ("convention", "orientations", "degrees"),
    [
        ("wxyz", TURNS.as_quat(scalar_first=True), False),
        ("wxyz", -TURNS.as_quat(scalar_first=True), False),
        ("xyzw", TURNS.as_quat() * np.where(np.arange(60) % 7, 1, -1)[:, None], False),
        ("matrix", TURNS.as_matrix(), False),
        ("xyz", TURNS.as_euler("xyz"), False),
        ("ZYX", TURNS.as_euler("ZYX", degrees=True), True),
    ],
)
def test_every_convention_gives_the_same_poses(convention, orientations, degrees):
    found = Demonstration.from_poses(T, POSITIONS, orientations, convention, degrees=degrees)
    np.testing.assert_array_equal(found.data[:, :3], POSITIONS)
    q = found.data[:, 3:]
    assert (np.sum(q[1:] * q[:-1], 1) > 0).all()
    assert q[0, 0] >= 0
    np.testing.assert_allclose(rotation.from_quaternion(q), TURNS.as_matrix(), atol=1e-12)


@pytest.mark.parametrize(
    ("orientations", "convention", "words"),
    [
        (np.where(np.arange(60)[:, None] == 7, 0, TURNS.as_quat()), "xyzw", "length 0 in row 7"),
        (TURNS.as_quat()[:9], "xyzw", "60 positions and 9"),
        (TURNS.as_quat(), "xyzz", "convention"),
        (TURNS.as_euler("xyz"), "xxz", "convention"),
        (TURNS.as_quat(), "matrix", "shape"),
        (2 * TURNS.as_matrix(), "matrix", "row 0"),
        (-TURNS.as_matrix(), "matrix", "det"),
    ],
)
def test_what_is_no_orientation_is_refused_with_its_row(orientations, convention, words):
    with pytest.raises(ArgumentError, match=words):
        Demonstration.from_poses(T, POSITIONS, orientations, convention)


def test_a_wide_turn_between_neighbours_is_told():
    jumping = Rotation.from_rotvec(np.outer(np.where(T > 0.5, 2.0, 0.0), [0, 0, 1.0]))
    with pytest.warns(DataWarning, match="115 degrees between rows 29 and 30"):
        Demonstration.from_poses(T, POSITIONS, jumping.as_quat(), "xyzw")


def turning(sign, offset=0.0):
    q = np.zeros((60, 4))
    q[:, 0], q[:, 3] = np.cos(1.4 * T + offset), np.sin(1.4 * T + offset)
    return Demonstration(T, sign * q, [Frame(np.eye(4), np.zeros(4))])


def test_recordings_of_opposite_sign_agree_in_data_and_views():
    given = [turning(1), turning(-1, 0.01), turning(1, 0.02)]
    found = agree(given)
    assert found[0] is given[0]
    assert found[2] is given[2]
    np.testing.assert_array_equal(found[1].data, -given[1].data)
    np.testing.assert_array_equal(found[1].observations[0], found[1].data)


def wrapped(offset):
    angle = 3.0 + 0.6 * T + offset
    return Demonstration(
        T,
        np.column_stack([(angle + np.pi) % (2 * np.pi) - np.pi, T]),
        Frame(np.eye(2), np.zeros(2)),
    )


def test_angles_unwrap_alike_also_where_one_starts_past_the_border():
    found = agree([wrapped(0.0), wrapped(0.1), wrapped(0.2)])
    for k, one in enumerate(found):
        np.testing.assert_allclose(one.data[:, 0], 3.0 + 0.6 * T + 0.1 * k, atol=1e-12)
        np.testing.assert_array_equal(one.data[:, 1], T)


def test_named_columns_need_no_jump():
    far = Demonstration(T, (3.0 + 0.1 * T)[:, None])
    near = Demonstration(T, (3.1 + 0.1 * T - 2 * np.pi)[:, None])
    assert agree([far, near])[1] is near
    np.testing.assert_allclose(agree([far, near], angles=0)[1].data[:, 0], 3.1 + 0.1 * T)
    with pytest.raises(ArgumentError, match="angles"):
        agree([far, near], angles=1)
    wide = Demonstration(T, np.stack([T, T], axis=1))
    with pytest.raises(ArgumentError, match=r"demonstrations have \[1, 2\] columns"):
        agree([far, wide], angles=1)


def test_plain_data_are_left_alone():
    rng = np.random.default_rng(0)
    given = [Demonstration(T, 3 * rng.normal(size=(60, 5))) for _ in range(3)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert all(a is b for a, b in zip(agree(given), given, strict=True))


@pytest.mark.parametrize(
    "retrieve",
    [
        lambda some: (
            gmr(
                fit_tp_gmm([d.with_time() for d in some], 4).adapt([some[0].with_time().frames[0]]),
                T,
            ).mean
        ),
        lambda some: fit_tp_promp(some, 10).adapt(some[0].frames).distribution(60).mean,
    ],
)
def test_learning_brings_recordings_into_agreement_and_says_so(retrieve):
    with pytest.warns(DataWarning, match=r"demonstrations \[1\]"):
        q = retrieve([turning(1), turning(-1), turning(1)])
    np.testing.assert_allclose(q, turning(1).data, atol=0.02)


def test_derivatives_of_jumping_columns_are_told():
    with pytest.warns(DataWarning, match="agree"):
        wrapped(0.0).with_derivatives(1)
