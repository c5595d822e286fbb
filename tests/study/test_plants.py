"""Plants unlike the model: the same trials again, beside their nominal twins."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.study import health
from tpsim.study.executor import perform_condition
from tpsim.study.plants import chosen, label, on_plants, section, with_plants
from tpsim.study.record import Records
from tpsim.study.study import Lab, Plan
from tpsim.task.task import draw_situation
from tpsim.task.verbs import perform, perform_beside
from tpsim.world.people.push import Push
from tpsim.world.perception import Perception
from tpsim.world.plant import PLANTS, Plant

HEAVY = {"heavy": Plant(payload=0.5), "late": Plant(latency=0.004)}


@pytest.fixture(scope="module")
def records(toy, models):
    """All trials of the toy study and, after them, those on two plants."""
    study = with_plants(toy, HEAVY)
    found, phases = Records(toy.task, models), study.conditions(Lab(study, models), Plan(0, 1, 2))
    conditions = next(phases)
    while True:
        for condition in conditions:
            found.add(condition, perform_condition(study, models, condition))
        try:
            conditions = phases.send(found)
        except StopIteration:
            return found


def test_every_pushed_trial_is_repeated_on_every_plant(records):
    nominal = [r.condition for r in records.select("pushed")]
    assert nominal
    for name, plant in HEAVY.items():
        on_it = [r.condition for r in records.select(label(name))]
        assert on_it == [replace(c, label=label(name), plant=plant) for c in nominal]
    assert list(on_plants(nominal, {})) == []


def test_a_plant_moves_otherwise_and_its_twin_is_found(records):
    for pushed, heavy in zip(records.select("pushed"), records.select(label("heavy")), strict=True):
        assert np.abs(pushed["q"] - heavy["q"]).max() > 1e-4
        assert heavy.beside("unpushed") is pushed.beside("unpushed")


def test_the_table_has_a_row_for_each_plant_and_counts_what_went_wrong(records, toy):
    measures = [*toy.all_measures, health.INJECTED]
    table = section(records, measures, HEAVY).table
    assert [row["plant"] for row in table] == ["nominal", *HEAVY]
    assert all(row["diverged"] == 0 for row in table)
    column = f"{health.INJECTED.title} [J]"
    for row, group in zip(table, ("pushed", label("heavy"), label("late")), strict=True):
        expected = max(health.injected(r).max() for r in records.select(group))
        assert row[column] == pytest.approx(expected)
        assert row["trials"] == len(records.select(group))


def test_a_fork_under_a_camera_is_the_trial_that_was_pushed_from_the_start(toy, models):
    """What was seen, what is on its way and what is believed are forked with the rest."""
    situation = draw_situation(toy.task, 0, 1)
    push = Push("tip", (1.0, 2.0, 0.0), 0.2, 0.1)
    plant = Plant(perception=Perception(rate=30.0))
    still, forked = perform_beside(toy.task, models, situation, [push], plant=plant)
    whole = perform(toy.task, models, situation, people=[push], plant=plant)
    told = perform(toy.task, models, situation)
    for name in ("q", "dq", "torque"):
        np.testing.assert_array_equal(forked[name], whole[name])
    assert np.abs(still["q"] - told["q"]).max() > 1e-5


def test_plants_are_chosen_by_name():
    assert chosen(("all",)) == dict(PLANTS)
    assert chosen(("latency 1 ms",)) == {"latency 1 ms": Plant(latency=0.001)}
    with pytest.raises(ArgumentError, match="no plant 'ice'; there are mass 5 %"):
        chosen(("ice",))


def test_a_study_without_such_trials_says_what_it_has(toy, models):
    study = with_plants(toy, HEAVY, of="shaken")
    phases = study.conditions(Lab(study, models), Plan(0, 1, 1))
    found = Records(toy.task, models)
    next(phases)
    with pytest.raises(ArgumentError, match="no trials 'shaken'"):
        phases.send(found)
