"""A task that does not fit its world is told so before anything long begins."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from tpsim import lab
from tpsim.errors import ArgumentError, TpsimError
from tpsim.task.check import check
from tpsim.tasks.pointing.task import Pointing

TIP = lab.Site("tip")


@dataclass(frozen=True)
class Changed(Pointing):
    views: Any = field(default_factory=dict)
    goal: Any = None
    recorded: Any = None

    def behaviours(self):
        return {"try": lab.Behaviour(self.views, lambda world, rng: None)}

    def goals(self):
        return {"near": lab.Goal(self.goal, 0.1)} if self.goal else {}

    def sites(self):
        return self.recorded or super().sites()


@pytest.mark.parametrize(
    ("task", "words"),
    [
        (Changed(views={"a": lab.Site("nose").pose}), "'a' of behaviour 'try': no site 'nose'"),
        (Changed(views={"a": TIP.seen_from(lab.Object("tea")).pose}), "no object 'tea'.*it has"),
        (Changed(views={"a": lab.Joints("arm_.*")}), "no joint matches 'arm_"),
        (Changed(views={"a": TIP}), "is no view; say which part, such as .pose"),
        (Changed(views={"a": TIP.position.minus([1.0])}), "origin of 1 numbers"),
        (Changed(views={}), "behaviour 'try', views: dict of 0 entries was given"),
        (Changed(views=[TIP.pose]), "behaviour 'try', views: list of 1 entries was given"),
        (
            Changed(views={"a": lab.Joints().spare(TIP.axis("x", across="y"), TIP.position[:2])}),
            "no freedom beneath these views",
        ),
        (Changed(views={"a": TIP.pose}, goal=lab.Site("nose").position), "goal 'near': no site"),
        (Changed(views={"a": TIP.pose}, recorded={"x": "nose"}), "recorded site 'x': no site"),
    ],
)
def test_what_does_not_fit_is_one_line(task, words):
    with pytest.raises(TpsimError, match=words) as caught:
        lab.teach(task, 1)
    assert "\n" not in str(caught.value)


def test_a_task_that_fits_passes():
    check(Pointing())


def test_a_robot_that_cannot_be_taken_in_is_one_line():
    arm = """<mujoco><worldbody><body><joint name="j" axis="0 1 0"{more}/><geom size="0.1" mass="2"
    pos="0.5 0 0"/><site name="tip"/></body></worldbody></mujoco>"""
    for text, options, words in [
        ("<mujoco><worldbody/></mujoco>", {}, "'hand' is at 'tip', which is no site"),
        (arm.format(more=""), {"hands": {}}, "hands is empty"),
        (arm.format(more=""), {"hands": {"hand": "nose"}}, "which is no site; the sites are tip"),
        (arm.format(more=' type="free"'), {"torque_limit": 5}, "base is free"),
        (arm.format(more=' type="ball"'), {"torque_limit": 5}, "is a ball joint"),
        (arm.format(more=""), {"torque_limit": 2, "home": (0,)}, "cannot hold itself up at home"),
        (arm.format(more=""), {}, "no torque limit for j: pass torque_limit="),
    ]:
        with pytest.raises(ArgumentError, match=words) as caught:
            lab.Robot.from_mjcf(text, **{"hands": {"hand": "tip"}, **options})
        assert "\n" not in str(caught.value)


def test_teaching_that_fails_says_why():
    def lesson(world, rng):
        return lab.Lesson(world.robot.home, (), 0.1, objects=(lab.ObjectPath.at("tea", (0, 0, 0)),))

    def unreachable(world, rng):
        return lab.reach(world.robot, {"tip": lab.Pose(np.eye(3), np.array([9.0, 0, 0]))})

    @dataclass(frozen=True)
    class Taught(Pointing):
        show: Any = lesson

        def behaviours(self):
            return {"try": lab.Behaviour({"tip": TIP.position}, self.show)}

    with pytest.raises(TpsimError, match="no movable object 'tea'"):
        lab.teach(Taught(), 1)
    with pytest.raises(
        TpsimError, match=r"0 of 1 .*: 10 unreachable; the last one: unreachable: poses of"
    ):
        lab.teach(Taught(show=unreachable), 1)


def test_a_trial_says_what_touched_first():
    arm = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" pos="0 0 -0.2"/>
    <body name="link"><joint name="j" axis="0 1 0" armature="0.1" damping="1"/>
    <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.02" mass="1"/>
    <site name="tip" pos="0.5 0 0"/></body></worldbody></mujoco>"""
    robot = lab.Robot.from_mjcf(arm, {"hand": "tip"}, torque_limit=20, home=(0.0,))

    class Fall:
        def command(self, state, time):
            return np.zeros(1)

    trial = lab.rollout(lab.world(robot), Fall(), robot.home, 0.8)
    assert trial.outcome == "contact" and trial.touched == "world and link"


def test_a_file_with_a_floor_a_sky_and_a_camera_of_its_own_keeps_them():
    arm = """<mujoco><asset><texture name="sky" type="skybox" builtin="flat" width="8" height="8"/>
    <material name="floor"/></asset><worldbody><camera name="hero"/><light name="key"/>
    <geom name="floor" type="plane" size="1 1 1" pos="0 0 -1"/><body name="link"><joint name="j"
    axis="0 0 1"/><geom size="0.1" mass="1"/><site name="tip"/></body></worldbody></mujoco>"""
    robot = lab.Robot.from_mjcf(arm, {"hand": "tip"}, torque_limit=20)
    model = lab.world(robot).model
    assert (model.geom_type == 0).sum() == 1 and model.ncam == 1
    with pytest.raises(TpsimError, match=r"the scene cannot be put together: .*link"):
        lab.world(robot, objects={"link": "marker"})
