"""Trial i is a pure function of the campaign and i."""

from collections import Counter

import numpy as np
import pytest

from tpsim.campaign.campaign import Campaign, Sweep, read_campaign
from tpsim.campaign.design import (
    asked,
    block_size,
    blocks,
    lead_of,
    lessons_of,
    per_situation,
    push_of,
    trials_of,
)
from tpsim.campaign.people import AXES, Leads, Pushes, Span
from tpsim.errors import ArgumentError, RecordingError
from tpsim.study.files.checked import from_json, to_json
from tpsim.world.plant import Plant

GRID = Campaign(
    "toy.py:study",
    240,
    controllers=("learned", "still"),
    plants={"nominal": Plant(), "heavy": Plant(payload=0.2)},
    teachers=2,
    pushes=Pushes(force=(5.0, 10.0), onset=Span(0.5, 1.5)),
    sweeps={"effort": Sweep((0.1, 0.2), learn=False), "grip": Sweep((1.0, 2.0))},
)
CUBE = Campaign(
    "toy.py:study",
    90,
    pushes=Pushes(direction="sphere", force=Span(5, 30), impulse=None, duration=(1.0, 2.0)),
    design="latin hypercube",
    repeats=6,
)


def test_a_campaign_comes_back_from_json():
    for one in (GRID, CUBE):
        assert from_json(to_json(one), Campaign, "it") == one


def test_a_file_needs_to_say_only_what_differs(tmp_path):
    file = tmp_path / "mine.json"
    file.write_text('{"study": "cup", "pushes": {"force": {"low": 5, "high": 9}}, "trials": 7}')
    assert read_campaign(file) == Campaign("cup", 7, pushes=Pushes(force=Span(5, 9)))
    file.write_text('{"study": "cup", "pushs": {}}')
    with pytest.raises(RecordingError, match="pushs"):
        read_campaign(file)


def test_a_grid_combines_all_levels_in_every_situation():
    assert GRID.labs == 4
    assert per_situation(GRID) == 2 * 6 * 2
    situation = [asked(GRID, i) for i in range(per_situation(GRID) * GRID.crossed)]
    assert {(a.situation, a.lesson.number) for a in situation} == {(0, 0)}
    cells = Counter(
        (a.controller, a.plant, a.fields["effort"], a.drawn["force"], a.drawn["direction"])
        for a in situation
    )
    assert len(cells) == 2 * 2 * 2 * 2 * 6 and set(cells.values()) == {1}
    assert {a.drawn["direction"] for a in situation} == set(AXES)


def test_pairs_share_situation_and_push():
    """Controllers, plants, and values of a sweep differ in nothing else."""
    by_point, by_push = {}, {}
    for i in range(GRID.trials):
        a = asked(GRID, i)
        by_point.setdefault(a.point, []).append(a)
        push = (a.lesson.teacher, a.situation, a.drawn["force"], a.drawn["direction"])
        by_push.setdefault(push, set()).add(a.drawn["onset"])
    for pairs in by_point.values():
        assert len({(a.situation, a.lesson.number, str(a.drawn)) for a in pairs}) == 1
        assert len({(a.controller, a.plant) for a in pairs}) == 4
    assert all(len(onsets) == 1 for onsets in by_push.values())
    assert len(set.union(*by_push.values())) > 20


def test_a_trial_does_not_depend_on_others():
    """Nor on how many there are, in a grid."""
    longer = Campaign(**{**vars(GRID), "trials": 10_000_000})
    for i in (0, 57, 239):
        assert asked(longer, i) == asked(GRID, i)
    with pytest.raises(ArgumentError, match="no trial 240; it has 0 to 239"):
        asked(GRID, 240)


def test_lessons_are_shown_by_every_teacher_for_every_value():
    found = [asked(GRID, per_situation(GRID) * GRID.crossed * k).lesson for k in (0, 1)]
    assert [(one.number, one.teacher, dict(one.fields)) for one in found] == [
        (0, 0, {"grip": 1.0}),
        (1, 1, {"grip": 1.0}),
    ]


def test_a_hypercube_divides_every_span_evenly():
    drawn = [asked(CUBE, i).drawn for i in range(CUBE.trials)]
    force = np.sort([d["force"] for d in drawn])
    cells = np.floor((force - 5) / 25 * CUBE.trials)
    np.testing.assert_array_equal(cells, np.arange(CUBE.trials))
    height = np.sort([d["direction"][2] for d in drawn])
    np.testing.assert_array_equal(np.floor((height + 1) / 2 * 90), np.arange(90))
    assert Counter(d["duration"] for d in drawn) == {1.0: 45, 2.0: 45}
    assert np.allclose(np.linalg.norm([d["direction"] for d in drawn], axis=1), 1)


@pytest.mark.parametrize("campaign", [GRID, CUBE])
def test_blocks_cover_all_trials_once_and_know_their_lessons(campaign):
    trials = [i for k in range(blocks(campaign)) for i in trials_of(campaign, k)]
    assert trials == list(range(campaign.trials))
    assert block_size(campaign) % campaign.crossed == 0
    for k in range(blocks(campaign)):
        own = {asked(campaign, i).lesson.number for i in trials_of(campaign, k)}
        assert own == set(lessons_of(campaign, k))


def test_impulse_and_phase_say_force_and_onset():
    people = Pushes(impulse=(10.0,), phase=(0.0, 0.5, 1.0), duration=(0.5,))
    drawn = {"impulse": 10.0, "phase": 0.5, "duration": 0.5, "direction": (0.0, 0.0, 1.0)}
    push = push_of(people, drawn, 2.0, "hand")
    assert (push.body, push.force, push.start) == ("hand", (0.0, 0.0, 20.0), 0.75)
    late = push_of(people, {**drawn, "phase": 1.0}, 2.0, "hand")
    assert late.start + late.duration == pytest.approx(2.0)
    with pytest.raises(ArgumentError, match=r"from 1\.8 s for 0\.5 s, and the trial lasts 2 s"):
        push_of(people, {**drawn, "onset": 1.8}, 2.0, "hand")


def test_a_lead_ends_before_the_trial():
    drawn = {"travel": 0.1, "phase": 1.0, "duration": 0.5, "direction": (1.0, 0.0, 0.0)}
    lead = lead_of(Leads(), drawn, 2.0, "hand")
    assert lead.travel == (0.1, 0.0, 0.0)
    assert 1.95 < lead.start + lead.duration + lead.rest < 2.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Pushes(force=(1.0,), impulse=(1.0,)), "both force and impulse; give one"),
        (lambda: Pushes(onset=(1.0,), phase=(0.5,)), "both onset and phase"),
        (lambda: Pushes(force=(-1.0,)), "give values from 0 on"),
        (lambda: Pushes(phase=Span(0.5, 1.5)), "from 0 to 1"),
        (lambda: Pushes(duration=(0.0,)), "above 0"),
        (lambda: Pushes(direction=((0, 0, 0),)), "not zero, 'circle' or 'sphere'"),
        (lambda: Span(2, 1), "give low < high"),
        (lambda: Sweep(), "values or a span"),
        (lambda: Sweep(span=Span(0, 1)), "learn = false"),
        (lambda: Campaign("cup", pushes=Pushes(), leads=Leads()), "give one of them"),
        (lambda: Campaign("cup", plants=("frictoin",)), "there is no plant 'frictoin'"),
        (lambda: Campaign("cup", controllers=("a", "a")), "name each once"),
        (lambda: Campaign("cup", 0), "trials"),
    ],
)
def test_contradictions_are_said(make, words):
    with pytest.raises(ArgumentError, match=words):
        make()
