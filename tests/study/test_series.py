"""The report and the film of a study that draws nothing itself."""

import numpy as np
import pytest

from tpsim.study import clips, series
from tpsim.study.condition import Condition
from tpsim.study.measure import Measure, rms
from tpsim.study.record import Records
from tpsim.study.study import Lab, Study
from tpsim.task.task import Situation
from tpsim.world.people.push import Push
from tpsim.world.trial import Channels, Trial


def gap(record):
    return record["gap"]


LARGEST = Measure("gap_max", of=gap, unit="mm", limit=2.0, title="Gap, largest")
RMS = Measure("gap_rms", of=gap, unit="mm", reduce=rms, limit=1.0)


@pytest.fixture
def records(toy):
    """Two situations, unpushed and pushed, under two controllers; gaps 1, 2, ... mm."""
    found = Records(toy.task, {})
    time = np.arange(20) / 100
    for index in range(2):
        for controller in ("learned", "still"):
            for label in ("unpushed", "pushed"):
                push = (Push("tip", (1.0, 0.0, 0.0)),) if label == "pushed" else ()
                arrays = {
                    "time": time,
                    "q": np.zeros((20, 2)),
                    "gap": np.full(20, 1.0 + len(found)),
                    "push_wrench": np.zeros((20, 6)),
                    "push_point": np.zeros((20, 3)),
                    "hand_position": np.zeros((20, 3)),
                }
                trial = Trial(arrays, channels=Channels(("hand",), people=("push",)))
                condition = Condition(label, Situation((), index=index), controller, push)
                found.add(condition, trial)
    return found


def figures(section):
    return [picture.content for picture in section.pictures]


def titles(figure):
    return [axis.get_title(loc="left") for axis in figure.axes]


def test_a_row_for_each_label_a_panel_for_each_controller(records):
    _, section = series.sections(records, [LARGEST, RMS])
    assert section.title == "Gap, largest"
    first, second = figures(section)
    assert titles(first) == ["unpushed, learned", "unpushed, still"]
    assert titles(second) == ["pushed, learned", "pushed, still"]
    one, other, limit = first.axes[0].lines
    assert (one.get_ydata()[0], other.get_ydata()[0]) == (1.0, 5.0)
    assert limit.get_ydata()[0] == 2.0
    colours = [[axis.lines[0].get_color() for axis in figure.axes] for figure in (first, second)]
    assert colours[0] == colours[1]


def test_controllers_stand_beside_each_other_in_a_table(records):
    beside, _ = series.sections(records, [LARGEST, RMS])
    assert list(beside.table) == [
        {"controller": "learned", "Gap, largest [mm]": 6.0, "gap_rms [mm]": 6.0},
        {"controller": "still", "Gap, largest [mm]": 8.0, "gap_rms [mm]": 8.0},
    ]


def test_one_controller_needs_one_row(records, toy):
    alone = Records(toy.task, {}, [(r.condition, r.trial) for r in records.select()])
    (section,) = series.sections(alone, [RMS])
    (figure,) = figures(section)
    assert titles(figure) == ["unpushed", "pushed"]
    # The limit on the rms is none on the curve.
    assert len(figure.axes[0].lines) == 2


def test_numbers_and_missing_labels_are_not_drawn(records):
    number = Measure("number", of=lambda record: 3.0)
    elsewhere = Measure("elsewhere", of=gap, label="led")
    assert [s.title for s in series.sections(records, [number, elsewhere])] == [
        "Controllers beside each other"
    ]


def test_the_film_shows_teaching_the_first_performance_and_the_worst_push(records, toy):
    study = Study(toy.task, [LARGEST, RMS])
    lab = Lab(study, {}, {"bring": [records[0].trial]})
    demonstration, unpushed, pushed = clips.clips(lab, records)
    assert (
        demonstration.title == "Demonstration: bring"
        and demonstration.speed == clips.TEACHING_SPEED
    )
    assert (unpushed.title, pushed.title) == ("Performance: unpushed", "Performance: pushed")
    # Under the learned controller the gaps of pushed trials are 2 and 6: over limits 2 and 1.
    assert pushed.subtitle == "the worst trial: gap_rms 6 mm"
    assert len(pushed.traces) == 1 and len(pushed.arrows) == 1


def test_a_film_without_limits_shows_the_first_push(records, toy):
    lab = Lab(Study(toy.task), {}, {})
    unpushed, pushed = clips.clips(lab, records)
    assert (unpushed.subtitle, pushed.subtitle) == ("where it was never shown", "a person pushes")
    assert clips.clips(lab, Records(toy.task, {})) == []
