"""What pages show, without a browser: the planar example, and recorded trials."""

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.play.plane import Plane, tube
from tpsim.task.task import draw_situation
from tpsim.task.verbs import perform


@pytest.fixture(scope="module")
def plane():
    return Plane()


def test_movements_follow_the_frames(plane):
    """All moved and turned by one rigid motion, ellipses and movements move and turn with it."""
    before = plane.retrieve()
    c, s = np.cos(0.7), np.sin(0.7)
    R, p = np.array([[c, -s], [s, c]]), np.array([0.3, -0.2])
    for k, frame in enumerate(list(plane.frames)):
        turned = R @ frame.A
        plane.move(k, R @ frame.b + p, np.arctan2(turned[1, 0], turned[0, 0]))
    after = plane.retrieve()
    np.testing.assert_allclose(after.components.mean, before.components.mean @ R.T + p, atol=1e-9)
    np.testing.assert_allclose(
        after.components.covariance, R @ before.components.covariance @ R.T, atol=1e-9
    )
    for name, path in before.paths.items():
        moved = after.paths[name]
        one, other = (x.mean if isinstance(x, Gaussian) else x for x in (path, moved))
        np.testing.assert_allclose(other, one @ R.T + p, atol=1e-6)


def test_methods_are_chosen_by_name(plane):
    plane.choose(["TP-GMR"])
    assert set(plane.retrieve().paths) == {"TP-GMR"}
    with pytest.raises(ArgumentError, match="no method 'x'"):
        plane.choose(["x"])
    with pytest.raises(ArgumentError, match="at least 2"):
        plane.learn(1, 3)


def test_a_tube_is_as_wide_as_the_deviation_across():
    x = np.column_stack([np.linspace(0, 1, 20), np.zeros(20)])
    left, right = tube(Gaussian(x, np.tile(np.diag([9.0, 0.04]), (20, 1, 1))))
    np.testing.assert_allclose(left - x, np.tile([0, 0.2], (20, 1)), atol=1e-12)
    np.testing.assert_allclose(x - right, np.tile([0, 0.2], (20, 1)), atol=1e-12)


def test_a_recorded_moment_looks_as_it_did(study, models):
    pytest.importorskip("viser")
    from tpsim.play.recorded import Scrubbed

    trial = perform(study.task, models, draw_situation(study.task, 0, 0))
    picture = Scrubbed(study.task.stage).picture(trial, 25)
    body = study.task.stage.model.body("lower").id
    R = picture.xmat[body].reshape(3, 3)
    tip = picture.xpos[body] + R @ [0.3, 0, 0]
    np.testing.assert_allclose(tip, trial["hand_position"][25], atol=1e-12)
    np.testing.assert_array_equal(picture.mocap[0][0], trial["mark_position"][25])


def test_ellipsoids_are_where_their_frames_are(study, models):
    """Of a model seen from the mark: centre and axes are those of the Gaussian, moved along."""
    from tpsim.play.learned import ellipsoids, weights
    from tpsim.pose import Pose
    from tpsim.robot.objects import Objects

    robot, gaussian = study.task.stage.robot, models["bring"].frames[0]
    R = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    state = robot.at(robot.home, None, Objects.of({"mark": Pose(R, np.array([0.3, 0.1, 0.0]))}))
    (shape,) = ellipsoids(study.task, models, state)["bring: mark"]
    np.testing.assert_allclose(
        shape.centre, R @ gaussian.mean[0] + np.array([0.3, 0.1, 0]), atol=1e-12
    )
    covariance = (shape.axes * shape.size**2) @ shape.axes.T
    np.testing.assert_allclose(covariance, R @ gaussian.covariance[0] @ R.T, atol=1e-5)
    shares = weights(study.task, models)
    assert shares.keys() == {"bring: mark", "bring: posture"}
    assert all(((s >= 0) & (s <= 1)).all() for s in shares.values())
