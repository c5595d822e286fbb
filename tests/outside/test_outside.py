"""What a user adds: three robots, a task with its study, a controller, a view, a method."""

import ast
import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tpsim

FOLDER = Path(__file__).parent
PUBLIC = {"tpsim", "tpsim.lab", "tpsim.section8"}


@pytest.fixture(scope="module", params=["servo", "jaco"])
def hover(request):
    """The task on a robot, what was taught, and what was learned."""
    from laboratory.hover import Hover

    from tpsim import lab

    if request.param == "jaco":
        pytest.importorskip("dm_control")
    task = Hover(request.param)
    taught = lab.teach(task, 6)
    return task, taught, lab.learn(task, taught)


def test_only_public_names_are_used():
    for file in (FOLDER / "laboratory").glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                names = [node.module]
            ours = {name for name in names if name.split(".")[0] == "tpsim"}
            assert ours <= PUBLIC, f"{file.name} imports {ours - PUBLIC}"


def test_a_task_with_its_study_is_one_file_of_sixty_lines():
    assert len((FOLDER / "laboratory" / "hover.py").read_text().splitlines()) <= 60


def test_robots_have_the_torque_limits_of_their_files_or_arguments():
    from laboratory import robots

    arm = robots.servo_arm()
    assert arm.joints == ("yaw", "shoulder", "elbow", "wrist", "roll")
    np.testing.assert_allclose(arm.torque_limit, [60, 80, 50, 15, 8])
    np.testing.assert_allclose(robots.planar().torque_limit, 20)
    assert len(robots.jaco().joints) == 6


def test_what_was_taught_is_precise_and_what_was_not_is_soft(hover):
    models = hover[2]
    gap, posture = (frame.covariance[0] for frame in models["hover"].frames)
    assert np.sqrt(np.diag(gap)).max() < 0.01
    assert np.sqrt(np.diag(posture)).max() > 0.1


def test_the_hand_finds_the_marker_where_it_was_never_put(hover):
    from tpsim import lab

    task, _, models = hover
    trial = lab.perform(task, models, lab.draw_situation(task, 7, 0), duration=3.5)
    assert trial.outcome == "done"
    marker, hand = (trial.pose(name).position for name in ("marker", "hand"))
    apart = np.linalg.norm(hand - marker - (0, 0, 0.12), axis=1)
    assert apart[0] > 0.03 and apart[trial.time > 3].max() < 0.01


def test_the_gripper_stays_under_its_own_servo():
    from laboratory.hover import Hover

    world = Hover("servo").stage
    simulation = world.simulation()
    simulation.reset(world.robot.home)
    for _ in range(300):
        simulation.step(world.robot.gravity_torque(simulation.q))
    fingers = [simulation.data.joint(name).qpos[0] for name in ("left", "right")]
    np.testing.assert_allclose(fingers, 0.02, atol=2e-3)


def test_an_arm_without_redundancy_says_so():
    from laboratory.robots import jaco

    from tpsim import lab

    robot = jaco()
    spare = lab.Joints().spare(lab.Site("wristsite").pose)
    with pytest.raises(ValueError, match="no freedom beneath these views: 6 joints for 6 dim"):
        spare(robot.at_home)
    free = lab.Joints().spare(lab.Site("wristsite").position)
    assert len(free.labels(robot)) == 3


def test_the_view_follows_its_jacobian_and_its_object():
    from laboratory.robots import planar
    from laboratory.view import Distance

    from tpsim import lab

    world, rng = lab.world(planar(), objects={"marker": "marker"}), np.random.default_rng(0)
    view, robot = Distance("tip", "marker"), world.robot
    for _ in range(5):
        q, p = rng.uniform(-1, 1, robot.n), rng.uniform(-1, 1, 3)
        objects = {"marker": lab.Pose(np.eye(3), p)}
        J, h = view(robot.at(q, objects=objects)).jacobian, 1e-6
        for i, step in enumerate(h * np.eye(robot.n)):
            ahead, behind = (view(robot.at(q + s, objects=objects)).value for s in (step, -step))
            np.testing.assert_allclose((ahead - behind) / (2 * h), J[:, i], atol=1e-8)
    path = lab.ObjectPath("marker", ((0.3, 0.3, 0.0), (0.5, 0.2, 0.0)), (0.0, 0.5))
    seen = []

    class Watch:
        def command(self, state, time):
            seen.append(view(state))
            return -4.0 * state.mass @ state.dq + state.bias

    lab.rollout(world, Watch(), robot.home, 0.1, objects=[path])
    values = np.array([s.value[0] for s in seen])
    drifts = np.array([s.drift[0] for s in seen])
    np.testing.assert_allclose(np.diff(values) / world.timestep, drifts[1:], atol=1e-3)


def test_the_controller_is_a_baseline_in_a_study(hover):
    from laboratory.controller import Spring

    from tpsim import lab

    task, _, models = hover
    situation = lab.draw_situation(task, 7, 0)
    spring = Spring(task.gap, stiffness=2000, damping=300)
    trial = lab.perform(task, models, situation, controller=spring, duration=3.0)
    marker, hand = (trial.pose(name).position for name in ("marker", "hand"))
    apart = np.linalg.norm(hand - marker - (0, 0, 0.12), axis=1)
    assert trial.outcome == "done" and apart[-1] < 0.02 < apart[0]
    assert "stiffness" not in trial.arrays


def test_the_method_is_a_row_of_the_comparison(tmp_path):
    section8 = pytest.importorskip("tpsim.section8")
    from laboratory.method import stepwise

    from tpsim.section8.plan import QUICK

    plan = replace(QUICK, seeds=(0,), situations=2, samples=30, distances=(1.0,))
    methods = {"mine": stepwise, "TP-GMR": section8.METHODS["TP-GMR"]}
    rows = section8.compare(methods, plan, folder=tmp_path)["methods"]
    assert rows["mine"]["rms"] < 2 * rows["TP-GMR"]["rms"] and rows["mine"]["end"] < 1e-3


def test_the_command_line_runs_the_study_of_a_file(tmp_path):
    file = FOLDER / "laboratory" / "hover.py"
    run = [sys.executable, "-m", "tpsim", "run", f"{file}:study", "--folder", str(tmp_path / "run")]
    small = ["--robot", "servo", "--situations", "1", "--pushes", "1", "--no-video", "--json"]
    path = os.pathsep.join([str(FOLDER), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [*run, *small, "--workers", "1"],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout)
    assert answer["trials"] == 2 and answer["figures"]["gap_mm"] < 10
    assert Path(answer["paths"]["report"]).is_file()


@pytest.mark.skipif("TPSIM_SITE" not in os.environ, reason="make wheel sets where the wheel is")
def test_the_wheel_is_what_is_tested():
    assert Path(tpsim.__file__).is_relative_to(os.environ["TPSIM_SITE"])
