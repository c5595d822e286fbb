import time
from dataclasses import replace

import numpy as np
import pytest

from tpsim.errors import RecordingError
from tpsim.study.files.trial_file import load_trial, save_trial
from tpsim.world.trial import Channels, Trial

TEXTS = {"schema": 2, "outcome": "done", "channels": "", "about": "{}"}
TEXTS["channels"] = '{"sites": [], "hands": [], "objects": [], "people": []}'


@pytest.fixture
def trial():
    rng = np.random.default_rng(1)
    arrays = {
        "time": np.arange(50) / 100,
        "q": rng.normal(size=(50, 14)),
        "beyond_limits": rng.normal(size=(50, 14)) > 2,
        "saturated_steps": np.arange(50),
        "cup_position": rng.normal(size=(50, 3)),
        "cup_quaternion": rng.normal(size=(50, 4)),
    }
    about = {"behaviour": "cup", "seed": 3, "attempt": 0}
    return Trial(arrays, "contact", Channels(objects=("cup",)), about)


def test_a_trial_comes_back_bit_for_bit(tmp_path, trial):
    back = load_trial(save_trial(tmp_path / "trial-000000.npz", trial))
    assert (back.outcome, back.about) == (trial.outcome, trial.about)
    assert back.channels == trial.channels
    assert back.arrays.keys() == trial.arrays.keys()
    for name, array in trial.arrays.items():
        assert back[name].dtype == array.dtype
        np.testing.assert_array_equal(back[name], array)


def test_the_same_trial_gives_the_same_bytes_at_any_time(tmp_path, trial, monkeypatch):
    first = save_trial(tmp_path / "a.npz", trial).read_bytes()
    monkeypatch.setattr(time, "time", lambda: 2e9)
    arrays, about = (dict(reversed(part.items())) for part in (trial.arrays, trial.about))
    shuffled = replace(trial, arrays=arrays, about=about)
    assert save_trial(tmp_path / "b.npz", shuffled).read_bytes() == first


def test_a_failed_write_leaves_nothing(tmp_path, trial, monkeypatch):
    def broken(file, **_):
        file.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", broken)
    with pytest.raises(KeyboardInterrupt):
        save_trial(tmp_path / "trial-000000.npz", trial)
    assert list(tmp_path.iterdir()) == []


def test_a_trial_is_never_overwritten(tmp_path, trial):
    path = save_trial(tmp_path / "trial-000000.npz", trial)
    path.write_bytes(b"other")
    assert load_trial(save_trial(path, trial, replace=True)).outcome == trial.outcome
    with pytest.raises(RecordingError, match="nothing is overwritten"):
        save_trial(path, trial)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("q", np.full((50, 14), np.nan), "q is not finite from row 0"),
        ("q", np.zeros((49, 14)), r"q is float64 \(49, 14\); signals are numbers \(50, ...\)"),
        ("time", np.zeros(50), "time must be a growing row"),
        ("time", np.full(50, np.nan), "time must be a growing row"),
        ("time", np.zeros(0), "time must be a growing row"),
        ("note", np.array(["x"] * 50), "note is <U1"),
        ("q", np.zeros((50, 14), complex), "q is complex128"),
    ],
)
def test_bad_signals_are_neither_written_nor_read(tmp_path, trial, name, value, words):
    bad = replace(trial, arrays={**trial.arrays, name: value})
    with pytest.raises(RecordingError, match=words):
        save_trial(tmp_path / "a.npz", bad)
    assert not list(tmp_path.iterdir())
    np.savez(tmp_path / "a.npz", **TEXTS, **bad.arrays)
    with pytest.raises(RecordingError, match=words):
        load_trial(tmp_path / "a.npz")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"about": "{"}, r"a.npz: about is no JSON"),
        ({"about": "[1]"}, r"about: Expected `object`, got `array`"),
        ({"about": '{"a": NaN}'}, "NaN is no number"),
        ({"about": '{"a": 1, "a": 2}'}, "a key occurs twice"),
        ({"about": '{"a": "\\ud800"}'}, "about is no JSON .*surrogate"),
        ({"about": "[" * 100_000}, "about is no JSON"),
        ({"about": np.zeros(3)}, "has no text 'about'"),
        ({"outcome": 3}, "has no text 'outcome'"),
        ({"channels": "{}"}, r"channels: the field `\w+` is missing - at `\$`"),
        ({"channels": TEXTS["channels"].replace("[]", "[7]")}, r"got `int` - at `\$.sites\[0\]`"),
        ({"channels": TEXTS["channels"].replace("[]", '["arm"]')}, "arm_position .* is missing"),
        ({"schema": 9}, "has schema 9, this tpsim reads 2"),
        ({"schema": 1}, "has schema 1, this tpsim reads 2; record it again"),
        ({"schema": 2.0}, "it has no schema"),
        ({"schema": [2, 2]}, "it has no schema"),
    ],
)
def test_a_tampered_trial_is_refused_with_file_and_field(tmp_path, changes, words):
    np.savez(tmp_path / "a.npz", time=np.arange(3.0), **{**TEXTS, **changes})
    with pytest.raises(RecordingError, match=words) as error:
        load_trial(tmp_path / "a.npz")
    assert str(error.value).startswith(str(tmp_path / "a.npz"))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", [*TEXTS, "time"])
def test_every_member_is_needed(tmp_path, name):
    members = {**TEXTS, "time": np.arange(3.0)}
    del members[name]
    np.savez(tmp_path / "a.npz", **members)
    with pytest.raises(RecordingError, match=f"no {name}|no text '{name}'|time must be"):
        load_trial(tmp_path / "a.npz")
