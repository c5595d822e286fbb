"""Serving: shown by hands, served again by what was learned; what is said of a trial is so."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim import rotation
from tpsim.study.condition import Condition
from tpsim.study.held import release_jump
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.task.acceptance import refusal
from tpsim.task.task import Situation, demonstration
from tpsim.task.verbs import learn, perform
from tpsim.tasks.serve import scene, study, teacher
from tpsim.tasks.serve.measures import Served, success
from tpsim.tasks.serve.task import GOALS, VIEWS, Serve
from tpsim.world.people.hold import Hold
from tpsim.world.teaching import demonstrate

TASK = Serve()


@pytest.fixture(scope="module")
def shown():
    """One demonstration, with the objects in the middle of their range."""
    lesson = teacher.lesson_in(TASK.stage, scene.home(), None, np.random.default_rng(1))
    return demonstrate(TASK.stage, lesson, TASK.sites())


@pytest.fixture(scope="module")
def performed(shown):
    """What was learned from it alone, where it was shown: condition, trial and models."""
    models = learn(replace(TASK, components=24), {"serve": [shown]})
    situation = Situation(tuple(shown["q"][0]), scene.at_rest(scene.home()))
    trial = perform(TASK, models, situation)
    return Condition("unpushed", situation), trial, models


def other(trial, **arrays):
    """The same trial with other signals."""
    return replace(trial, arrays={**trial.arrays, **arrays})


def test_objects_are_drawn_within_the_taught_range_and_stay_upright():
    rng, home = np.random.default_rng(0), scene.home()
    for _ in range(50):
        for name, (R, p) in scene.draw(rng).items():
            turned = rotation.log(R @ home[name].rotation.T)
            assert np.all(np.abs([*(p - home[name].position), turned[2]]) <= scene.RANGE + 1e-12)
            np.testing.assert_allclose(turned[:2], 0.0, atol=1e-12)


def test_the_teacher_takes_sugars_pours_and_puts_back(shown):
    assert shown.outcome == "done"
    assert refusal(TASK.stage.robot, shown, GOALS) is None
    assert Served.of(shown).faults == ()
    # The sugar is let fall into the cup from over its rim, and poured out of it.
    sugar = shown.pose("cup").inverse @ shown.pose("sugar")
    heights = sugar.position[:, 2]
    inside = np.hypot(*sugar.position[:, :2].T) < scene.RADIUS
    assert (inside & (np.abs(heights) < scene.RIM)).sum() > 300


def test_what_was_shown_once_is_served_again_stiffer_where_it_matters(performed):
    _, trial, models = performed
    assert trial.outcome == "done" and models["serve"].components == 24
    found = Served.of(trial)
    assert found.faults == () and found.end < 2.0
    ends = np.cumsum(list(teacher.PHASES.values()))
    when = dict(zip(teacher.PHASES, ends, strict=True))
    least = np.linalg.eigvalsh(trial["left_hand_stiffness"])[:, 0]
    middle = {name: t - teacher.PHASES[name] / 2 for name, t in when.items()}
    at = {name: least[np.searchsorted(trial.time, t)] for name, t in middle.items()}
    assert at["grasp"] > 1.5 * at["take"] and at["put"] > 1.5 * at["return"]


def test_every_fault_is_said(performed):
    _, trial, _ = performed

    def faults(**arrays):
        return set(Served.of(other(trial, **arrays)).faults)

    dock, bowl, cup = (trial[f"{name}_position"] for name in ("dock", "bowl", "cup"))
    assert faults(dock_position=dock + np.array([0.009, 0, 0])) == {"put beside"}
    assert "poured beside" in faults(bowl_position=bowl + np.array([0.011, 0, 0]))
    spilled = trial["sugar_position"] + np.array([0.0, 0.2, 0.0])
    assert faults(sugar_position=spilled) == {"sugar not in the cup", "sugar not in the bowl"}
    tilted = rotation.to_quaternion(
        rotation.exp([np.radians(9.0), 0, 0]) @ trial.pose("cup").rotation
    )
    carried = (trial.time > 5.0) & (trial.time < 5.5)
    turned = np.where(carried[:, None], tilted, trial["cup_quaternion"])
    assert faults(cup_quaternion=turned) == {"carried tilted"}
    still = np.tile(cup[0], (len(cup), 1))
    assert {"cup not put", "poured beside"} <= faults(cup_position=still)


def test_pushes_and_holds_go_round_all_parts(performed):
    _, _, models = performed
    lab = Lab(study.serve, models)
    rng, moments = np.random.default_rng(0), study.moments()
    starts = [0.0, *np.cumsum(list(teacher.PHASES.values()))]
    assert all(np.isclose(starts, t).any() for pair in moments.values() for t in pair)
    for k, (begin, end) in enumerate(moments.values()):
        push = study._push(rng, k + len(moments))
        assert begin <= push.start <= end
        assert np.linalg.norm(push.force) == pytest.approx(study.PUSH)
        hold = study._hold(rng, k)
        assert begin <= hold.start <= end and hold.duration == 5.0
    (found,) = study.conditions(lab, Plan(seed=3, situations=1, pushes=5))
    kinds = [(c.label, c.controller) for c in found]
    assert kinds[:6] == [("unpushed", "learned")] + 5 * [("pushed", "learned")]
    assert {c.controller for c in found if c.label == "held"} == {"learned", "by clock"}


def test_figures_of_held_hands(performed):
    condition, trial, models = performed
    records = Records(TASK, models, [(condition, trial)])
    limit, hold = TASK.stage.robot.torque_limit, Hold(scene.LEFT, 4.0, 5.0)
    torque = np.zeros_like(trial["torque"])
    torque[trial.time > 9.0] = 0.1 * limit
    held = replace(condition, label="held", hold=(hold,))
    twice = records.add(held, other(trial, torque=torque))
    figures = {m.name: m.figure(records) for m in study.serve.all_measures if "held" in m.name}
    assert figures["held_ratio"] == pytest.approx(1.0)
    assert figures["held_ratio_by_clock"] is None and figures["success_held_percent"] == 100.0
    assert release_jump(twice) == pytest.approx(10.0)
    assert success(twice) == 100.0
    assert {s.title for s in study.serve.sections(records)} >= {"What went wrong"}
    shown = study.serve.clips(Lab(study.serve, models), records)
    assert [clip.subtitle for clip in shown] == [
        "dock, sugar and bowl where they never were",
        "a person holds the hand for 5 s",
    ]
    assert {"cup", "sugar"} <= set(shown[0].objects)


def by_state(performed):
    """Controller, and a function that makes the state of some sample of the trial, or posture."""
    condition, trial, models = performed
    places = {path.name: path.first for path in condition.situation.objects}

    def state(k, q=None, moving=True):
        dq = trial["dq"][k] * moving
        return TASK.stage.robot.at(trial["q"][k] if q is None else q, dq, places)

    task = replace(TASK, progress="state")
    return task.controller(TASK.stage, models, condition.situation), state


def test_hands_are_looked_for_where_the_controller_wants_them(performed):
    controller, state = by_state(performed)
    progress = controller.progress
    progress.at(state(0), 0.0)
    hands = progress._cup_hand, progress._sugar_hand
    for tick in (40, 250, 270, 400, 500, 690):
        q = performed[1]["q"][3 * tick]
        for _ in range(6):
            step, _ = controller._between(state(0, q), 0.03 * tick, 0.0)
            q = q + step.mean
        # [m], [rad]: what is left is what spare joints ask of hands, and curvature.
        for hand in hands:
            asked = hand._passage.places.mean[tick]
            assert np.abs(hand._see(state(0, q)).value - asked).max() < 0.004


def test_progress_is_seen_in_both_hands_and_stands_still_with_them(performed):
    controller, state = by_state(performed)
    trial, ticks = performed[1], range(0, 1000, 3)
    found = np.array([controller.progress.at(state(k), trial.time[k]) for k in ticks])
    # Hands keep up, so that it goes on as the clock says, but for how far they stay behind.
    assert np.abs(found[:, 0] - trial.time[ticks]).max() < 0.3
    # Both are seen where they were: it stands still soon, and asks for little more.
    assert np.linalg.norm(trial["dq"][999]) > 0.05
    held = [
        controller.progress.at(state(999, moving=False), 0.01 * k) for k in range(1000, 1500, 3)
    ]
    assert held[-1][0] - held[0][0] < 0.5 and held[-1][1] < 0.05


def test_views_see_the_things_where_they_are(shown):
    seen = demonstration(TASK.stage, shown, VIEWS)
    assert [part.shape[1] for part in seen.observations] == [3] * 11 + [1, 1]
    # In the dock, the hand has the orientation about which it is charted.
    k = int(np.argmax(np.linalg.norm(np.diff(shown["cup_position"], axis=0), axis=1) > 1e-4))
    chart = dict(zip(VIEWS, seen.observations, strict=True))["cup hand turned from dock"]
    assert np.linalg.norm(chart[k]) < 0.1
