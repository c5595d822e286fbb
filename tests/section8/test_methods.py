"""Every method learns, adapts, and agrees with itself; a user's own joins them."""

import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations, u_frames
from tpsim.section8 import METHODS
from tpsim.section8.method import Anchor
from tpsim.section8.methods import method_from, with_methods_from
from tpsim.section8.planar import measure, situations

NAMES = (
    *("TP-GMM", "TP-MFA", "TP-trajGMM", "TP-GP", "TP-LWR", "GPR", "GPR-GMM", "PGMM"),
    *("TP-HDDC", "TP-MPPCA", "TP-ProMP", "TP-LQT", "KMP", "DMP"),
)
OWN = [name for name in METHODS if ":" not in name]
SEEN_FROM_FRAMES = [name for name in OWN if name.startswith("TP-")]
MEET_THE_END = [*SEEN_FROM_FRAMES, "ProMP", "KMP", "DMP"]
SLOPPY = {"TP-GMR product": 3.0, "TP-ProMP": 1.0, "TP-trajDistrib": 1.0, "TP-GP": 0.4}


@pytest.fixture(scope="module")
def learned():
    taught = u_demonstrations(5, 40)
    return {name: METHODS[name](taught) for name in OWN}


def test_the_names_of_the_contract_are_there():
    assert set(NAMES) <= set(METHODS)


@pytest.mark.parametrize("name", OWN)
def test_paths_are_movements_near_the_teacher(name, learned):
    near = situations()[0]
    path = learned[name](near)
    if isinstance(path, Gaussian):
        assert np.linalg.eigvalsh(path.covariance).min() > -1e-9
    figures = measure(path, near)
    assert figures["rms"] < (0.5 if name == "PGMM" else 0.35)
    assert figures["end"] < 0.25
    assert learned[name].parameters > 10


@pytest.mark.parametrize("name", MEET_THE_END)
def test_frames_or_a_goal_carry_the_end_far_away(name, learned):
    far = situations()[-1]
    assert measure(learned[name](far), far)["end"] < SLOPPY.get(name, 0.15)


def test_without_frames_the_end_is_lost_as_the_tutorial_says(learned):
    far = situations()[-1]
    for name in ("GPR", "GPR-GMM"):
        assert measure(learned[name](far), far)["end"] > 0.5


@pytest.mark.parametrize("name", SEEN_FROM_FRAMES)
def test_a_missing_frame_leaves_the_other(name, learned):
    frames = u_frames(np.random.default_rng(3))
    path = learned[name]([None, frames[1]])
    x = path.mean if isinstance(path, Gaussian) else path
    assert np.linalg.norm(x[-1] - frames[1].b) < 0.15


@pytest.mark.parametrize("name", ["GPR", "GPR-GMM", "PGMM"])
def test_task_parameters_need_every_frame(name, learned):
    with pytest.raises(ArgumentError, match="every frame"):
        learned[name]([None, u_frames(np.random.default_rng(3))[1]])


def test_an_anchor_is_where_the_demonstrations_meet():
    taught, frames = u_demonstrations(4, 20), u_frames(np.random.default_rng(0), 3.0)
    for step, j in ((0, 0), (-1, 1)):
        anchor = Anchor.at(taught, step)
        np.testing.assert_allclose(anchor(frames).mean, frames[j].b, atol=1e-9)
        without = [frame if i != j else None for i, frame in enumerate(frames)]
        assert np.trace(anchor(without).covariance) > 100 * np.trace(anchor(frames).covariance)
        with pytest.raises(ArgumentError, match="all frames are None"):
            anchor([None, None])


def test_a_method_comes_from_a_file(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text("def repeat(taught):\n    return lambda frames: taught[0].data\n")
    methods = with_methods_from([f"{file}:repeat"])
    taught = u_demonstrations(2, 10)
    assert methods["repeat"](taught)(taught[1].frames) is taught[0].data
    assert list(methods)[:-1] == list(METHODS)


@pytest.mark.parametrize(
    ("text", "name", "words"),
    [
        ("x = 1", "y", "no function 'y'"),
        ("import nothing_like_it", "f", "fails with ModuleNotFoundError"),
        ("def f(", "f", "fails with SyntaxError"),
    ],
)
def test_bad_files_of_methods(tmp_path, text, name, words):
    file = tmp_path / "bad.py"
    file.write_text(text)
    with pytest.raises(ArgumentError, match=words):
        method_from(f"{file}:{name}")


def test_bad_names_of_methods(tmp_path):
    for specification in ("mine.py", f"{tmp_path}/no.py:f"):
        with pytest.raises(ArgumentError, match=r"file\.py:function"):
            method_from(specification)
    file = tmp_path / "kmp.py"
    file.write_text("KMP = print")
    with pytest.raises(ArgumentError, match="already a method 'KMP'"):
        with_methods_from([f"{file}:KMP"])
