"""Films from recorded movements: what is drawn, how long they last, and what is refused."""

import dataclasses
import os
import subprocess
import sys

import imageio_ffmpeg
import mujoco
import numpy as np
import pytest
from PIL import Image

from tpsim.errors import ArgumentError, RenderingError, SimulationError
from tpsim.film import overlay, rendering, video
from tpsim.film.camera import viewpoint
from tpsim.film.clip import Arrow, Clip, Ellipsoid, Reading
from tpsim.robot.robot import Robot
from tpsim.tasks.cup_and_sugar.home import KNOWN
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.world.trial import Channels, Trial
from tpsim.world.world import World

draws = pytest.mark.skipif(rendering.backend() is None, reason=rendering.HINT)
SIZE = {"width": 320, "height": 192}


@pytest.fixture(scope="module")
def clip():
    time = np.linspace(0, 1, 11)
    point = np.tile([0.6, 0.1, 0.2], (11, 1))
    return Clip(
        world=CupAndSugar().stage,
        time=time,
        q=np.tile(KNOWN["baxter"], (11, 1)),
        title="title",
        subtitle="subtitle",
        arrows=(Arrow(point, np.tile([20.0, 0, 0], (11, 1))),),
        traces=(point + time[:, None] * [0, 0, 0.2],),
        ellipsoids=(Ellipsoid(point, np.tile(np.diag([100.0, 400, 900]), (11, 1, 1))),),
    )


@pytest.fixture
def canvas():
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    return mujoco.MjvScene(model, maxgeom=500)


def test_arrow_has_the_direction_of_its_force_and_ends_before_the_point(canvas):
    point, force = np.array([0.5, 0.2, 0.1]), np.array([0.0, 20, 0])
    overlay.arrow(canvas, point, force)
    geom = canvas.geoms[0]
    np.testing.assert_allclose(geom.mat[:, 2], [0, 1, 0], atol=1e-6)
    assert geom.pos[1] < point[1]


def test_no_force_no_arrow(canvas):
    overlay.arrow(canvas, np.zeros(3), np.zeros(3))
    assert canvas.ngeom == 0


def test_ellipsoid_axes_grow_with_the_root_of_stiffness(canvas):
    rotation = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    overlay.ellipsoid(canvas, np.zeros(3), rotation @ np.diag([100.0, 400, 900]) @ rotation.T)
    geom = canvas.geoms[0]
    np.testing.assert_allclose(geom.size / geom.size[0], [1, 2, 3], rtol=1e-5)
    np.testing.assert_allclose(np.abs(geom.mat.T @ rotation), np.eye(3), atol=1e-5)
    assert np.linalg.det(geom.mat) == pytest.approx(1, abs=1e-5)


def test_a_long_trace_costs_no_more_than_a_short_one(canvas):
    overlay.trace(canvas, np.linspace([0, 0, 0], [1, 0, 0], 5000), 0)
    assert 100 <= canvas.ngeom <= 310


def test_caption_changes_the_foot_of_the_picture_only():
    picture = np.full((192, 320, 3), 200, np.uint8)
    overlay.Caption("title", "subtitle", 320, 192).draw(picture, 1.0, 20.0)
    assert (picture[:160] == 200).all()
    assert (picture[-3:] < 60).all()


def test_readings_stand_out_beyond_their_limit():
    values = np.array([2.0, 4.0])
    reading = overlay.Readings([Reading("tilt", values, "deg", 3.0)], 192)
    below, beyond = np.zeros((2, 192, 320, 3), np.uint8)
    reading.draw(below, 0)
    reading.draw(beyond, 1)
    grey = np.ptp(below[:60].astype(int), axis=2)
    assert grey.max() < 20 and below[:60].max() > 200 and not below[60:].any()
    assert np.ptp(beyond[:60].astype(int), axis=2).max() > 60


@draws
def test_clips_side_by_side_are_each_drawn_as_alone(clip, tmp_path):
    near = dataclasses.replace(clip, centre=np.array([0.6, 0.1, 0.2]), close=clip.traces[0])
    both = np.asarray(Image.open(video.still([clip, near], 0.5, tmp_path / "both.png", **SIZE)))
    half = {"width": 160, "height": 192}
    alone = np.asarray(Image.open(video.still(clip, 0.5, tmp_path / "alone.png", **half)))
    np.testing.assert_array_equal(both[:, :160], alone)
    assert np.abs(both[:, 160:].astype(int) - alone).mean() > 10


def test_clips_side_by_side_are_as_long_as_each_other(clip):
    short = dataclasses.replace(
        clip, time=clip.time[:5], q=clip.q[:5], arrows=(), traces=(), ellipsoids=()
    )
    with pytest.raises(ArgumentError, match=r"\[5, 11\] samples"):
        video.film([[clip, short]], "nowhere.mp4")


def test_frames_follow_the_clock_at_the_speed_of_the_clip(clip):
    frames = video._samples(clip, 10)
    np.testing.assert_array_equal(frames, [*range(11), *[10] * 5])
    twice = video._samples(dataclasses.replace(clip, speed=2.0), 10)
    np.testing.assert_array_equal(twice, [0, 2, 4, 6, 8, 10, 10, 10, 10, 10, 10])


@draws
def test_film_has_every_frame_of_every_clip(clip, tmp_path):
    path = video.film([clip, clip], tmp_path / "film.mp4", fps=5, **SIZE)
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == 2 * len(video._samples(clip, 5))
    assert seconds == pytest.approx(frames / 5, abs=0.21)
    assert [p.name for p in tmp_path.iterdir()] == ["film.mp4"]


@draws
def test_still_shows_the_robot_and_repeats(clip, tmp_path):
    first = np.asarray(Image.open(video.still(clip, 0.5, tmp_path / "a.png", **SIZE)))
    again = np.asarray(Image.open(video.still(clip, 0.5, tmp_path / "b.png", **SIZE)))
    assert first.shape == (192, 320, 3)
    red = (first[..., 0] > 90) & (first[..., 1] < 40)
    assert red.mean() > 0.01
    np.testing.assert_array_equal(first, again)


def test_without_a_renderer_the_error_names_the_packages(clip, tmp_path, monkeypatch):
    monkeypatch.setattr(rendering, "backend", lambda: None)
    with pytest.raises(RenderingError, match="libegl1"):
        video.film([clip], tmp_path / "film.mp4", **SIZE)
    assert not list(tmp_path.iterdir())


def test_probe_survives_a_backend_that_cannot_be_imported():
    assert not rendering._draws("no such backend")


@pytest.mark.skipif(sys.platform != "linux", reason="the library of glfw has another name")
def test_mujoco_is_imported_without_a_process_of_glfw():
    code = """
import subprocess, sys
from tpsim.film.rendering import name_glfw
name_glfw()
subprocess.Popen = None  # glfw's search starts two
import mujoco, glfw.library
assert glfw.library.glfw is not None
mujoco.GLContext
"""
    ours = (rendering.LIBRARY, rendering.VARIABLE)
    environment = {key: value for key, value in os.environ.items() if key not in ours}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)


def test_a_library_of_glfw_that_is_named_is_left(monkeypatch):
    monkeypatch.setenv(rendering.LIBRARY, "/mine.so")
    rendering.name_glfw()
    assert os.environ[rendering.LIBRARY] == "/mine.so"


def test_unknown_camera_names_those_that_exist(clip, tmp_path):
    with pytest.raises(SimulationError, match=r"no camera 'moon'.*hero.*hands.*side"):
        video.still(clip, 0, tmp_path / "a.png", camera="moon")


def test_unknown_object_is_refused(clip, tmp_path):
    lost = dataclasses.replace(clip, objects={"ball": np.zeros((11, 3))})
    with pytest.raises(SimulationError, match="no object 'ball'"):
        video.still(lost, 0, tmp_path / "a.png")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q": np.zeros((5, 14))}, r"q of a clip has shape \(5, 14\): give \(11, 14\)"),
        ({"traces": (np.zeros((11, 2)),)}, r"trace .* give \(11, 3\)"),
        ({"q": np.full((11, 14), np.nan)}, "not finite"),
        ({"objects": {"ball": np.zeros((11, 4))}}, r"\(11, 3\) or \(11, 7\)"),
        ({"speed": 0.0}, "positive"),
        ({"time": np.zeros(11)}, "increasing"),
    ],
)
def test_clips_that_do_not_fit_are_refused(clip, change, message):
    with pytest.raises(ArgumentError, match=message):
        dataclasses.replace(clip, **change)


def test_a_film_needs_a_clip(tmp_path):
    with pytest.raises(ArgumentError, match="at least one"):
        video.film([], tmp_path / "film.mp4")


PLAIN = """
<mujoco>
  <worldbody>
    <body><joint name="hinge" axis="0 0 1" range="-90 90"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02" rgba="1 0 0 1"/>
      <site name="tip" pos="0.3 0 0"/></body>
    <body name="puck" mocap="true"><geom size="0.02" contype="0" conaffinity="0"/></body>
  </worldbody>
  <actuator><motor joint="hinge" ctrlrange="-5 5" ctrllimited="true"/></actuator>
</mujoco>"""


@pytest.fixture(scope="module")
def plain():
    """A world whose file has neither camera nor light."""
    return World.compose(Robot.from_mjcf(PLAIN, {"hand": "tip"}, velocity_limit=3.0))


@draws
def test_a_scene_without_cameras_is_framed_by_its_size(plain, tmp_path):
    clip = Clip(plain, np.array([0.0]), np.zeros((1, 1)))
    assert isinstance(viewpoint(plain.model), mujoco.MjvCamera)
    picture = np.asarray(Image.open(video.still(clip, 0, tmp_path / "a.png", **SIZE)), int)
    red = picture[..., 0] > picture[..., 1:].sum(-1) + 20
    rows, columns = np.nonzero(red)
    assert red.mean() > 0.005
    assert rows.min() > 0 and rows.max() < 191 and columns.min() > 0 and columns.max() < 319


def test_a_clip_of_a_trial_takes_people_and_objects_by_the_channels(plain):
    time = np.arange(3) / 100
    trial = Trial(
        {
            "time": time,
            "q": np.zeros((3, 1)),
            "puck_position": np.ones((3, 3)),
            "puck_quaternion": np.tile([1.0, 0, 0, 0], (3, 1)),
            "friend_wrench": np.tile([1.0, 2, 3, 4, 5, 6], (3, 1)),
            "friend_point": np.full((3, 3), 0.5),
            "odd_wrench": np.zeros((3, 6)),
        },
        channels=Channels(objects=("puck",), people=("friend",)),
    )
    clip = Clip.of(plain, trial, "title")
    (arrow,) = clip.arrows
    np.testing.assert_array_equal(arrow.force, np.tile([1.0, 2, 3], (3, 1)))
    np.testing.assert_array_equal(arrow.point, np.full((3, 3), 0.5))
    np.testing.assert_array_equal(clip.objects["puck"], np.tile([1, 1, 1, 1, 0, 0, 0], (3, 1)))


def test_q_of_another_robot_is_refused(plain, tmp_path):
    clip = Clip(plain, np.array([0.0]), np.zeros((1, 2)))
    with pytest.raises(SimulationError, match="q has 2 columns: the robot has 1 joints"):
        video.still(clip, 0, tmp_path / "a.png")
