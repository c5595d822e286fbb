"""Acceptance: a demonstration counts if the teacher did what it cares about, without straining."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim import lab, paths
from tpsim.errors import SimulationError
from tpsim.study import teaching
from tpsim.study.files.run import load_run
from tpsim.task.acceptance import errors, refusal
from tpsim.task.verbs import show_all
from tpsim.tasks.cup_and_sugar import cup
from tpsim.world.course import Shown
from tpsim.world.people.demonstrator import FIRM
from tpsim.world.teaching import Refusal, show

TIP = lab.Site("tip")
LOOSE = lab.Grip(600.0, 40.0, 0.0, 0.0, 30.0)


def leads(world, rng, grip=LOOSE, way=0.05):
    """Lead the tip up, by some way [m]; rarely the wrong way."""
    start, wrong = np.array([0.1, 0.9]), rng.random() < 0.4
    origin = world.robot.at(start).pose("tip").position
    travel = [0.0, -way if wrong else way, 0.0]
    path = lab.straight(origin, travel, 0.4, 0.2, world.timestep)
    return lab.Lesson(start, (lab.Guide("hand", "tip", grip, path),), 0.6)


@pytest.fixture
def task(planar_task):
    """A teacher who wants the tip 5 cm higher in the end."""
    made = type(planar_task)()
    made.__dict__["stage"] = planar_task.stage
    origin = planar_task.stage.robot.at(np.array([0.1, 0.9])).pose("tip").position
    up = TIP.position[:2].minus(origin[:2] + np.array([0, 0.05]))
    behaviour = lab.Behaviour({"tip": TIP.position}, leads, goals={"gap": lab.Goal(up, 0.02, -0.1)})
    object.__setattr__(made, "behaviours", lambda: {"lift": behaviour})
    return made


def test_what_misses_the_goal_is_refused_shown_again_and_counted(task):
    told = []
    shown = show_all(task, 3, 1, progress=lambda *given: told.append(given))["lift"]
    assert len(shown.trials) == 3
    refused = [words for _, _, words in told if words != "done"]
    assert shown.refusals == {"gap": len(refused)}
    assert shown.attempts == len(told) == 3 + len(refused) > 3
    for words in refused:
        name, value, unit, allowed, _ = words.split()
        assert (name, unit, allowed) == ("gap", "mm,", "20")
        assert 80 < float(value) < 120
    gaps = [
        errors(task.stage.robot, trial, task.behaviours()["lift"].goals)["gap"]
        for trial in shown.trials
    ]
    # Only the end counts.
    assert all(np.isnan(gap[:40]).all() and np.nanmax(gap) < 0.02 for gap in gaps)


def test_without_goals_all_that_went_well_is_accepted(task):
    free = replace(task.behaviours()["lift"], goals={})
    object.__setattr__(task, "behaviours", lambda: {"lift": free})
    shown = show_all(task, 4)["lift"]
    assert (shown.attempts, shown.refusals) == (4, {})


def test_a_teacher_who_always_fails_ends_in_one_clear_line(task):
    lift = task.behaviours()["lift"]
    goals = {"gap": replace(lift.goals["gap"], within=1e-5)}
    object.__setattr__(task, "behaviours", lambda: {"lift": replace(lift, goals=goals)})
    with pytest.raises(
        SimulationError, match=r"only 0 of 1 .* good; the others: 10 gap; the last one: gap .* mm, "
    ) as caught:
        lab.teach(task, 1)
    assert "\n" not in str(caught.value)


def test_a_teacher_who_pulls_with_all_its_strength_is_refused(task):
    weak = replace(LOOSE, max_force=0.5)
    lift = lab.Behaviour({"tip": TIP.position}, lambda world, rng: leads(world, rng, weak, 0.2))
    object.__setattr__(task, "behaviours", lambda: {"lift": lift})
    with pytest.raises(SimulationError, match=r"10 at its strength; .* % of the time, 10 allowed"):
        lab.teach(task, 1)


def test_angles_are_told_in_degrees(task):
    trial = show(task.stage, leads, 0, seed=0)
    bend = lab.Joints("b").minus([0.9 - np.radians(37)])
    assert refusal(task.stage.robot, trial, {"tilt": lab.Goal(bend, np.radians(5), 0, 0.001)}) == (
        Refusal("tilt", "tilt 37 deg, 5 allowed")
    )


def test_refusals_are_summed_over_behaviours():
    shown = {"one": Shown((), {"tilt": 2}), "two": Shown((), {"tilt": 1, "joint limit": 4})}
    assert teaching.refused(shown) == {
        "refused_demonstrations": 7,
        "refusals": {"joint limit": 4, "tilt": 3},
    }
    rows = teaching.section(shown).table
    assert rows[1]["refused"] == "1 tilt, 4 joint limit"


def test_firm_hands_are_what_they_were(cup_world):
    """A demonstration that was recorded before there were people is shown again alike."""
    assert FIRM.grip == lab.Grip(2000.0, 120.0, 60.0, 2.5, 60.0, 8.0)
    assert FIRM.variation == lab.Variation(0.002, 0.0006, 0.01, 0.003, 0.7, 0.1, 0.2, 0.3)
    recorded = next(iter(load_run(paths.demonstrations("cup")).trials()))
    seed, attempt = recorded.about["seed"], recorded.about["attempt"]
    again = show(cup_world, cup.lesson, attempt, seed=seed, sites={})
    np.testing.assert_allclose(again["q"], recorded["q"], atol=1e-6)
