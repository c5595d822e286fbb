import dataclasses

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from tpsim.errors import ArgumentError
from tpsim.study.executor import perform_all, perform_condition
from tpsim.study.files.about import Performed, TaskFile, read_about
from tpsim.task.verbs import perform
from tpsim.world.teaching import demonstrate


def same(one, other):
    """Whether all bits of two trials agree."""
    return (one.outcome, one.channels, one.about, one.arrays.keys()) == (
        other.outcome,
        other.channels,
        other.about,
        other.arrays.keys(),
    ) and all(one[name].tobytes() == other[name].tobytes() for name in one.arrays)


def test_a_condition_becomes_the_trial_of_its_controller(toy, models, conditions, trials):
    first = conditions[0]
    plain = perform(toy.task, models, first.situation)
    np.testing.assert_array_equal(trials[0]["q"], plain["q"])
    assert "stiffness" in trials[1].arrays
    assert np.ptp(trials[1]["push_wrench"][:, 1]) == pytest.approx(2.0)
    assert trials[2].time[-1] == pytest.approx(0.29)
    assert trials[2]["lead_wrench"].any()


def test_what_is_shown_draws_from_its_own_seed(toy, conditions, trials):
    situation = conditions[3].situation
    key = np.random.SeedSequence(situation.seed, spawn_key=(2, situation.index))
    lesson = toy.task.lesson(toy.task.stage, np.random.default_rng(key))
    shown = demonstrate(toy.task.stage, lesson, toy.task.sites())
    np.testing.assert_array_equal(trials[3]["q"], shown["q"])


def test_a_trial_says_how_to_perform_it_again(toy, conditions, trials):
    for condition, trial in zip(conditions, trials, strict=True):
        assert read_about(trial, "trial") == Performed(condition, TaskFile.of(toy))


def test_the_number_of_workers_changes_no_bit(toy, models, conditions, trials):
    again = list(perform_all(toy, models, conditions, workers=2))
    assert len(again) == len(trials)
    assert all(same(*pair) for pair in zip(trials, again, strict=True))


def test_linear_algebra_runs_on_one_thread(toy, models, conditions):
    seen = []

    def controller(world, models, situation):
        seen.extend(pool["num_threads"] for pool in threadpool_info())
        return toy.task.controller(world, models, situation)

    study = dataclasses.replace(toy, controllers={"mine": controller})
    perform_condition(study, models, dataclasses.replace(conditions[0], controller="mine"))
    assert set(seen) == {1}


def test_what_the_study_does_not_have_is_refused(toy, models, conditions):
    unknown = dataclasses.replace(conditions[0], controller="stil")
    with pytest.raises(ArgumentError, match=r"no controller 'stil'; it has learned, still, nearby"):
        list(perform_all(toy, models, [unknown]))
    with pytest.raises(ArgumentError, match="has no `show`"):
        list(perform_all(dataclasses.replace(toy, show=None), models, [conditions[3]]))
    with pytest.raises(ArgumentError, match="0 workers"):
        list(perform_all(toy, models, conditions, workers=0))
