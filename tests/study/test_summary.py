import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tpsim.study.summary import plain, summary


@dataclass(frozen=True)
class Setting:
    effort: float
    gains: np.ndarray


def test_any_result_becomes_plain_json():
    result = {
        "a": np.float64(0.5),
        "b": np.arange(3),
        "c": Path("x") / "y",
        "d": (1, None, True),
        "e": float("nan"),
        "f": np.array([np.inf, 1.0]),
        3: Setting(0.01, np.eye(2)),
        "g": np.bool_(True),
    }
    text = json.dumps(plain(result), allow_nan=False)
    assert json.loads(text) == {
        "a": 0.5,
        "b": [0, 1, 2],
        "c": "x/y",
        "d": [1, None, True],
        "e": None,
        "f": [None, 1.0],
        "3": {"effort": 0.01, "gains": [[1.0, 0.0], [0.0, 1.0]]},
        "g": True,
    }


def test_a_summary_is_aligned_text():
    result = {
        "task": "cup",
        "trials": 60,
        "figures": {"tilt_max_deg": 3.14159, "diverged": False, "worst": None},
        "paths": {"run": Path("runs/x")},
        "missing": [{"missing": "film", "command": "apt"}, {"missing": "x", "command": "pip"}],
        "notes": ["one", "two"],
        "force": [0.0, 20.0, 0.0],
        "missing too": [],
    }
    assert summary(result) == "\n".join(
        [
            "task         cup",
            "trials       60",
            "",
            "figures",
            "  tilt max deg  3.142",
            "  diverged      no",
            "  worst         -",
            "",
            "paths",
            "  run  runs/x",
            "",
            "missing",
            "  missing  command",
            "  film     apt",
            "  x        pip",
            "",
            "notes",
            "  - one",
            "  - two",
            "force        0 20 0",
            "missing too  nothing",
        ]
    )
