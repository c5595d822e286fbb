"""A camera: its pictures come at its rate, late, with its noise, and not of what is hidden."""

import numpy as np
import pytest

from tpsim import Gaussian, rotation
from tpsim.catalogue.ours import planar5
from tpsim.controllers.product import Product, Skill
from tpsim.errors import ArgumentError, UnseenError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.robot.views.sites import Object, Site
from tpsim.world.perception import Camera, Perception
from tpsim.world.trial import Channels, Trial

ROWS = {"cup": 0, "box": 1}
RNG = np.random.default_rng(8)


def placed(x=0.0):
    return Objects.of(
        {"cup": Pose(np.eye(3), np.array([x, 0, 0])), "box": Pose(np.eye(3), np.ones(3))}
    )


def looking(perception, seconds, step=0.005, x=lambda t: 0.0):
    """What is known at every step, while the cup moves along x(t)."""
    camera = Camera(perception, ROWS, placed(x(0.0)))
    times = step * np.arange(round(seconds / step))
    return times, [camera.look(t, placed(x(t))) for t in times], camera


def test_what_is_known_changes_at_the_rate_and_comes_late():
    """Without noise to speak of, a jump at 0.5 s is seen in the next picture, 50 ms after it."""
    sharp = Perception(rate=10, latency=0.07, position_noise=1e-6, angle_noise=1e-6)
    times, known, _ = looking(sharp, 1.5, x=lambda t: 0.3 * (t > 0.51))
    places = np.array([one["cup"].position[0] for one in known])
    arrived = times[np.argmax(places > 0.15)]
    assert arrived == pytest.approx(0.6 + 0.07, abs=0.006)
    assert abs(places[-1] - 0.3) < 1e-3
    changes = times[1:][np.diff(places) != 0]
    assert len(changes) <= 1.5 * 10 + 1


def test_noise_is_what_was_asked_for():
    """Single sightings, as a filter that forgets at once shows them."""
    rough = Perception(
        rate=100, latency=0.0, position_noise=0.005, wander=(100.0, 100.0), before=0.0
    )
    off, turned = [], []
    for seed in range(300):
        camera = Camera(Perception(**{**vars(rough), "seed": seed}), ROWS, placed())
        known = camera.look(0.0, placed())["cup"]
        off.append(known.position)
        turned.append(rotation.log(known.rotation))
    for found, asked in ((off, rough.position_noise), (turned, rough.angle_noise)):
        assert np.sqrt(np.mean(np.sum(np.square(found), 1))) == pytest.approx(asked, rel=0.1)


def test_the_same_seed_sees_the_same_and_hiding_one_changes_nothing_of_the_other():
    hidden = Perception(occluded=(("cup", 0.2, 0.8),))
    (_, one, _), (_, again, _), (_, other, _) = (
        looking(p, 1.0) for p in (Perception(),) * 2 + (hidden,)
    )
    for a, b, c in zip(one, again, other, strict=True):
        assert np.array_equal(a.positions, b.positions)
        assert np.array_equal(a["box"].position, c["box"].position)
    deviation = np.sqrt([known.covariance("cup")[0, 0] for known in other])
    assert deviation[170] > 1.5 * deviation[45]
    assert deviation[-1] < deviation[170]


def test_what_never_appears_is_not_there_and_is_said():
    _, known, camera = looking(Perception(occluded=(("cup", -5.0, 50.0),)), 0.5)
    assert camera.unseen == ("cup",)
    assert "cup" not in known[-1] and list(known[-1]) == ["box"]
    with pytest.raises(UnseenError, match="'cup' was not seen yet"):
        known[-1]["cup"]


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Perception(rate=0), "rate"),
        (lambda: Perception(occluded=(("cup", 2.0, 1.0),)), "give a time that is later"),
        (
            lambda: Camera(Perception(occluded=(("mug", 0.0, 1.0),)), ROWS, placed()),
            "no object 'mug'",
        ),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(call, words):
    with pytest.raises(ArgumentError, match=words):
        call()


def test_precision_of_views_fades_by_how_they_move_with_their_objects():
    """W^-1 + G S G', with G by finite differences in the pose of the object."""
    robot = planar5()
    views = {
        "position": Site("left_hand").seen_from(Object("cup")).position[:2],
        "turn": Site("right_hand").seen_from(Object("cup")).orientation,
        "own": Site("left_hand").position,
    }
    frames = tuple(Gaussian(np.zeros((1, d)), 0.01 * np.eye(d)[None]) for d in (2, 3, 3))
    product = Product([Skill(views, TPGMM(np.ones(1), frames))])
    where, S = (
        Pose(rotation.exp([0.1, 0.2, 0.9]), np.array([0.3, 0.4, -0.05])),
        np.diag([1, 2, 3, 40, 50, 60]),
    )
    S = 1e-3 * S
    sure = Objects.of({"cup": where})
    unsure = Objects({"cup": 0}, sure.positions, sure.quaternions, covariances=S[None])

    def stacked(pose):
        state = robot.at(robot.home, objects={"cup": pose})
        return np.concatenate([view(state).value for view in views.values()])

    G, h = np.empty((8, 6)), 1e-6
    for k, d in enumerate(np.eye(6)):
        moved = [
            stacked(
                Pose(rotation.exp(s * h * d[3:]) @ where.rotation, where.position + s * h * d[:3])
            )
            for s in (1, -1)
        ]
        G[:, k] = (moved[0] - moved[1]) / (2 * h)
    found = product.at(robot.at(robot.home, objects=unsure)).precision
    np.testing.assert_allclose(
        found, np.linalg.inv(0.01 * np.eye(8) + G @ S @ G.T), rtol=1e-5, atol=1e-6
    )
    exact = product.at(robot.at(robot.home, objects=sure)).precision
    np.testing.assert_allclose(exact, 100 * np.eye(8))


def test_a_trial_is_remembered_with_its_objects_as_all_pictures_show_them():
    """Hidden for half of the time, the cup is known from the other half; the robot is as it was."""
    time = np.linspace(0.0, 3.0, 301)
    where, turned = (
        np.array([0.4, -0.2, 0.1]),
        rotation.to_quaternion(rotation.exp([0.0, 0.0, 1.0])),
    )
    arrays = {
        "time": time,
        "q": RNG.normal(size=(301, 2)),
        "cup_position": np.tile(where, (301, 1)),
        "cup_quaternion": np.tile(turned, (301, 1)),
    }
    trial = Trial(arrays, channels=Channels(objects=("cup",)))
    for hidden in ((), (("cup", 0.5, 2.0),)):
        found = Perception(occluded=hidden, seed=1).remembered(trial)
        assert found["q"] is trial["q"]
        assert 1e-5 < np.linalg.norm(found["cup_position"] - where, axis=1).max() < 0.004
        assert 1 - np.abs(found["cup_quaternion"] @ turned).min() < 2e-4
    with pytest.raises(ArgumentError, match="'cup' was never seen"):
        Perception(occluded=(("cup", -9.0, 9.0),)).remembered(trial)
