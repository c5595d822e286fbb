"""Trials in 3-D inside a report: which they are, and that they move as they did."""

import base64
import json
import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from tpsim.errors import RecordingError
from tpsim.study import clips, embedded
from tpsim.study.condition import Condition
from tpsim.study.measure import Measure
from tpsim.study.record import Records
from tpsim.study.study import Lab
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, perform, teach
from tpsim.world.people.push import Push


def _push(record):
    return np.linalg.norm(record["push_wrench"][:, :3], axis=1)


@pytest.fixture(scope="module")
def lab(toy):
    taught = teach(toy.task, 2)
    measure = Measure("push", of=_push, unit="N", limit=12.0)
    return Lab(replace(toy, measures=[measure]), learn(toy.task, taught), taught)


@pytest.fixture(scope="module")
def records(lab):
    """Four trials, pushed more and more."""
    found = Records(lab.task, lab.models)
    for index, force in enumerate((5.0, 0.5, 20.0, 10.0)):
        situation = draw_situation(lab.task, 0, index)
        push = Push("tip", (0.0, force, 0.0), start=0.05, duration=0.2)
        trial = perform(lab.task, lab.models, situation, people=[push])
        found.add(Condition("pushed", situation, "learned", (push,)), trial)
    return found


def test_best_median_and_worst_are_by_their_limits(lab, records):
    shown = clips.best_median_worst(lab, records)
    assert list(shown) == [
        "best: pushed, situation 1; at 4 % of its nearest limit",
        "median: pushed, situation 0; at 42 % of its nearest limit",
        "worst: pushed, situation 2; at 167 % of its nearest limit",
    ]
    np.testing.assert_array_equal(list(shown.values())[2].q, records[2]["q"])


def test_without_limits_one_trial_is_shown(lab, records):
    plain = Lab(replace(lab.study, measures=[]), lab.models, lab.taught)
    assert list(clips.best_median_worst(plain, records)) == ["a trial: pushed, situation 0"]
    assert clips.best_median_worst(plain, Records(lab.task, lab.models)) == {}
    assert embedded.embedded({}) == ""


def played(part, number):
    """Messages of a recording, and its arrays put back in their places."""
    import msgspec
    import zstandard

    (held,) = re.findall('<script type="application/json">(.*?)</script>', part, re.DOTALL)
    content = base64.b64decode(json.loads(held)["played"][number])
    size = int.from_bytes(content[:8], "little")
    inner = zstandard.ZstdDecompressor().decompress(content[8:], max_output_size=size)
    length = int.from_bytes(inner[:8], "little")
    return msgspec.msgpack.decode(inner[8 : 8 + length])


def test_a_trial_plays_as_it_was(lab, records):
    """Of the arm's links, every pose that is sent is that of the recorded joint angles."""
    pytest.importorskip("viser")
    shown = clips.best_median_worst(lab, records)
    part = embedded.embedded(shown)
    assert len(part) < embedded.LARGEST
    assert part.count("<button") == 3
    recording = played(part, 2)
    trial, model = records[2].trial, lab.world.model
    data = mujoco.MjData(model)
    assert recording["durationSeconds"] == pytest.approx(trial.time[-1] + 1.0, abs=0.05)
    lower, sent = model.body("lower").id, 0
    for time, message in recording["messages"]:
        if message["type"] == "SetPositionMessage" and message["name"] == f"/bodies/{lower}":
            sample = np.searchsorted(trial.time, time + 1e-6, side="right") - 1
            data.qpos[:] = trial["q"][sample]
            mujoco.mj_kinematics(model, data)
            np.testing.assert_allclose(message["position"], data.xpos[lower], atol=2e-5)
            sent += 1
    assert sent > 5


def test_without_viser_the_report_says_what_to_install(lab, records, monkeypatch):
    def missing(*_):
        raise RecordingError("pages in 3-D need the package viser: pip install 'tpsim[play]'")

    monkeypatch.setattr(embedded, "pages", missing)
    part = embedded.embedded(clips.best_median_worst(lab, records))
    assert part.startswith('<p class="hint">Trials are not shown in 3-D here')
    assert "tpsim[play]" in part
