"""Figures of trials and their twins: what has nothing to say, what never comes, and when."""

from dataclasses import replace

import numpy as np
import pytest

from tpsim.campaign.run import campaign
from tpsim.campaign.table import read_table
from tpsim.study.measure import Measure
from tpsim.study.metrics import push_interval
from tpsim.study.reference import load_study


def looked(record):
    """Last moment [s] at which somebody pushes, or of the trial."""
    span = push_interval(record.trial)
    return record.trial.time[-1] if span is None else span[1]


MEASURES = (
    Measure("looked", of=looked),
    Measure("absent", of=lambda record: None, limit=1.0),
    Measure("endless", of=lambda record: np.inf, limit=1.0),
)


@pytest.mark.parametrize(("measures", "success"), [(MEASURES[:2], True), (MEASURES, False)])
def test_nothing_to_say_is_no_failure_and_what_never_comes_is_one(
    described, tmp_path, measures, success
):
    asked = replace(described, trials=2, controllers=("learned",), plants=("nominal",))
    study = replace(load_study(asked.study), measures=measures)
    answer = campaign(asked, tmp_path / "out", study=study)
    rows = read_table(tmp_path / "out" / "table.parquet").to_pylist()
    assert answer["failed"] == 0, rows[0]["reason"]
    for row in rows:
        assert row["success"] is success
        assert row["absent"] is None and row.get("endless") is None
        # In the twin nobody pushes, and yet the same part of it is looked at.
        assert row["twin_looked"] == row["looked"] == pytest.approx(0.2, abs=0.02)
