"""Tasks on robots that nobody here wrote: homes, workspaces, and one short task on OpenArm."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim import rotation
from tpsim.catalogue import ours
from tpsim.errors import ArgumentError
from tpsim.robot import anatomy
from tpsim.robot.views.joints import Spare
from tpsim.scene.compose import world
from tpsim.task.task import Situation, draw_situation
from tpsim.task.verbs import learn, perform
from tpsim.tasks.cup_and_sugar import cup, home, sugar
from tpsim.tasks.cup_and_sugar.study import cup_and_sugar
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.tasks.pointing.pointers import spatial
from tpsim.tasks.transfer import arrangement, docks
from tpsim.tasks.transfer.task import Transfer
from tpsim.tasks.workplace import Workplace, size_of, with_spare_joints
from tpsim.world import rehearsal
from tpsim.world.comfort import comfortable
from tpsim.world.people.push import Push
from tpsim.world.teaching import teach


def test_the_default_robot_has_size_1_and_its_old_place(cup_world):
    place = Workplace.of(cup_world.robot)
    assert place.size == 1.0
    assert place.middle == (0.06, 0.0, 0.13)
    np.testing.assert_allclose(place.furniture()["table"].position, (0.7, 0.0, -0.22), atol=1e-9)


def test_homes_that_were_found_before_are_what_they_say(cup_world):
    state = cup_world.robot.at_home
    np.testing.assert_array_equal(state.q, home.KNOWN["baxter"])
    np.testing.assert_allclose(sugar.ABOVE.position(state).value, home.PLACE, atol=1e-4)


def test_comfortable_postures_satisfy_their_views_with_torque_to_spare(cup_world):
    robot = cup_world.robot
    exact = [cup.LEVEL, sugar.ABOVE.position.minus(home.PLACE)]
    first, *others = comfortable(robot, exact, starts=3)
    for q in (first, *others):
        state = robot.at(q)
        assert max(np.abs(view(state).value).max() for view in exact) < 1e-6
        assert ((q >= robot.lower) & (q <= robot.upper)).all()
    assert np.abs(robot.gravity_torque(first) / robot.torque_limit).max() < 0.8


def test_a_home_is_found_for_arms_that_have_none(cup_world, monkeypatch):
    monkeypatch.setattr(home, "AHEAD", (0.56,))
    monkeypatch.setattr(home, "BELOW", (0.0,))
    monkeypatch.setattr(home, "STARTS", 3)
    monkeypatch.setattr(home, "DRAWS", 4)
    held, there = home.home(ours.baxter(), "unknown", 0.5)
    found = world(ours.baxter(), held=held).with_home(there.home)
    assert home.reached(found, 0.5) >= home.HALF
    assert np.degrees(np.linalg.norm(cup.LEVEL(there.at_home).value)) < 1e-3


@pytest.mark.parametrize("way", [0, 1])
def test_a_cup_is_held_upright_by_its_handle_whichever_way_the_hand_is_turned(monkeypatch, way):
    robot, turned = ours.baxter(), np.array(home.KNOWN["baxter"])
    last = robot.index("left_w2")
    # Half a turn about the axis along which the hand reaches.
    turned[last] += np.pi * way * -np.sign(turned[last])
    monkeypatch.setitem(home.KNOWN, "turned", turned.tolist())
    held, there = home.home(robot, "turned", 1.0)
    assert held is home.WAYS[way]
    state = there.at_home
    assert np.linalg.norm(cup.LEVEL(state).value) < 1e-3
    # The handle is between the fingers, and the cup ahead of them.
    hand, pose = state.pose("left_gripper"), state.pose("cup")
    origin = pose.position - 0.045 * pose.rotation[:, 2]
    np.testing.assert_allclose(origin, hand.position + 0.056 * hand.rotation[:, 2], atol=1e-9)
    np.testing.assert_allclose(pose.rotation[:, 0], hand.rotation[:, 2], atol=1e-9)


def test_too_large_a_workspace_is_said_with_how_much_is_reached(cup_world, monkeypatch):
    monkeypatch.setattr(home, "_candidates", lambda stage: [np.array(home.KNOWN["baxter"])])
    monkeypatch.setattr(home, "reached", lambda world, room, least=0.0: 0.3 / room)
    with pytest.raises(ArgumentError, match=r"reaches 30 % .*14 cm ahead.*give --room 0\.5"):
        home.home(ours.baxter(), "long", 1.0)


def test_a_home_that_cannot_be_held_names_the_joint(cup_world):
    robot, q = cup_world.robot, cup_world.robot.home.copy()
    q[robot.index("left_s1")] = 0.0
    q[robot.index("left_e1")] = 0.0
    lacks = np.abs(robot.gravity_torque(q)) - robot.torque_limit
    with pytest.raises(ArgumentError, match=rf"'left_s1' lacks {lacks.max():.1f} Nm"):
        cup_world.with_home(q)


def test_one_hand_is_too_few_for_two(robot_of):
    robot_of("jaco")
    with pytest.raises(ArgumentError, match="needs two hands, left_hand and right_hand; this"):
        CupAndSugar(robot="jaco").stage  # noqa: B018


def test_arms_of_six_joints_have_none_to_spare(robot_of, cup_world):
    six, seven = robot_of("viperx"), cup_world.robot
    spare = {name for name, view in sugar.VIEWS.items() if isinstance(view, Spare)}
    assert set(with_spare_joints(sugar.VIEWS, seven)) == set(sugar.VIEWS)
    assert set(sugar.VIEWS) - set(with_spare_joints(sugar.VIEWS, six)) == spare


@pytest.mark.parametrize(("name", "free"), [("baxter", 5), ("jaco", 4)])
def test_the_joints_that_are_free_while_pointing_complete_its_direction(name, free, robot_of):
    robot = robot_of(name)
    pointer = spatial(robot)
    assert len(pointer.free) == free
    chain = robot.chain("left_gripper")
    others = [i for i in chain if robot.joints[i] not in pointer.free]
    turned = pointer.axis(robot.at_home).jacobian[:, others]
    assert abs(np.linalg.det(turned)) > 0.2


@pytest.mark.parametrize("name", ["jaco", "openarm"])
def test_the_docks_of_transfer_go_with_the_arm(name, robot_of):
    robot_of(name)
    task = Transfer(robot=name)
    robot, layout = task.stage.robot, task.layout
    hand = robot.at_home.pose("left_gripper")
    down = layout.rotation @ [0, 0, -1]
    assert hand.rotation[:, 2] @ down > np.cos(0.4)
    assert np.linalg.norm(hand.position - layout.middle(robot)) < 0.25 * task.size
    assert robot.is_comfortable(robot.home)
    start = draw_situation(task, 0, 0)
    reach = anatomy.length(robot, "left_gripper")
    for path in start.objects:
        away = path.first.position - anatomy.shoulder(robot, "left_gripper")
        assert 0.3 * reach < np.linalg.norm(away) < 0.8 * reach


def test_docks_that_are_tilted_keep_their_places_beside_each_other(dock_world):
    robot = dock_world.robot
    usual = docks.home(robot)
    tilted = docks.home(robot, docks.Layout((0.1, 0.2, -0.3), 1.2))
    for placed in (usual, tilted):
        (R, p), (R_end, p_end) = placed["start"], placed["end"]
        between = R.T @ (p_end - p)
        turned = R.T @ R_end
        if placed is usual:
            expected = between, turned
    np.testing.assert_allclose(between, expected[0], atol=1e-12)
    np.testing.assert_allclose(turned, expected[1], atol=1e-12)
    middle = (p + p_end) / 2 - sum(pose.position for pose in usual.values()) / 2
    np.testing.assert_allclose(middle, [0.1, 0.2, -0.3], atol=1e-12)
    # What pointed down points ahead.
    np.testing.assert_allclose(R @ [0, 0, -1], [np.sin(1.2), 0, -np.cos(1.2)], atol=1e-12)


def test_the_pace_is_that_at_which_no_joint_hurries(monkeypatch):
    stage = Transfer().stage
    monkeypatch.setattr(arrangement, "DRAWS", 3)
    share, pace = arrangement.led(stage, docks.STANDARD)
    assert share >= arrangement.ENOUGH * 2 / 3 and pace == 1.0
    # Where joints may be half as fast, the way lasts about twice as long.
    monkeypatch.setattr(rehearsal, "EASY", rehearsal.EASY / 2)
    share, pace = arrangement.led(stage, docks.STANDARD)
    assert share >= arrangement.ENOUGH * 2 / 3 and 1.6 < pace < 2.6


@pytest.fixture
def tried(monkeypatch):
    """Layouts that a search tries, and what comes of each: shares of ways and paces, in turn."""
    found, answers = [], []
    monkeypatch.setattr(arrangement, "homes", lambda robot, layout, rng: [robot.home])

    def led(stage, layout):
        found.append(layout)
        return answers[len(found) - 1] if len(found) <= len(answers) else (0.0, 1.0)

    monkeypatch.setattr(arrangement, "led", led)
    return found, answers


def test_a_search_takes_the_first_layout_that_is_good_enough(tried, dock_world):
    layouts, answers = tried
    # The second one is led everywhere, but so slowly that the arm must be nearly singular.
    answers += [(0.25, 1.0), (1.0, 3 * arrangement.SLOWEST), (0.75, 1.5), (1.0, 1.0)]
    found, home_ = arrangement.search(dock_world, "arm")
    assert len(layouts) == 3 and found == replace(layouts[2], pace=1.5)
    np.testing.assert_array_equal(home_, dock_world.robot.home)
    assert layouts[0] == docks.STANDARD


def test_a_search_that_finds_little_takes_the_best_or_says_how_little(tried, dock_world):
    layouts, answers = tried
    answers += [(0.25, 1.0), (0.5, 1.0), (0.375, 1.0)]
    assert arrangement.search(dock_world, "arm").layout == layouts[1]
    assert len(layouts) == len(arrangement.candidates())
    layouts.clear()
    answers[1] = (0.3, 1.0)
    answers[2] = (0.3, 1.0)
    with pytest.raises(ArgumentError, match=r"arm can be led .* in 30 % of their places at most"):
        arrangement.search(dock_world, "arm")


def test_a_study_of_another_robot_is_made_anew():
    softer = cup_and_sugar.with_task(friction=90.0)
    assert softer.contest.yielding == cup_and_sugar.contest.yielding
    assert softer.task.friction == 90.0


def test_openarm_keeps_a_cup_level_while_it_is_pushed(robot_of):
    """One short task: taught twice by hand, learned, and pushed, with the friction of its file."""
    robot_of("openarm")
    task = CupAndSugar(("cup",), robot="openarm", room=0.6, teacher="firm")
    world, behaviour = task.stage, task.behaviours()["cup"]
    assert size_of(world.robot) == 0.46
    assert world.robot.friction.min() > 0
    taught = teach(world, behaviour.teacher, 2, seed=0, sites=task.sites()).trials
    models = learn(task, {"cup": taught})
    start = Situation(tuple(world.robot.home))
    push = Push("left_gripper", (0.0, 9.0, 0.0), start=0.2, duration=0.8)
    short = {"duration": 1.0}
    pushed = perform(task, models, start, people=[push], **short)
    still = perform(task, models, start, **short)
    tilt = np.degrees([rotation.tilt(R) for R in pushed.pose("cup")[0]])
    away = pushed["left_hand_position"] - still["left_hand_position"]
    assert pushed.outcome == "done" and pushed["saturated_steps"][-1] == 0
    assert tilt.max() < 5.0
    assert np.linalg.norm(away, axis=1).max() > 0.03
    assert replace(task, robot="baxter").size == 1.0
