"""Folders of policies: whole or not at all, no pickles, and every damage named in one line."""

import json
import shutil

import numpy as np
import pytest

from tpsim.cli import main as cli
from tpsim.deploy import folder as files
from tpsim.deploy.policy import Policy
from tpsim.deploy.values import Reader, taken_apart
from tpsim.errors import ArgumentError, RecordingError
from tpsim.robot.views.joints import Joints
from tpsim.robot.views.sites import Object, Site
from tpsim.robot.views.view import View

TIP, CUP = Site("tip"), Object("cup")

VIEWS = [
    TIP.pose,
    TIP.seen_from(CUP).position[:2],
    TIP.seen_from(Site("base")).orientation.about(np.eye(3)).minus((0.1, 0, 0)),
    TIP.axis("x", across="y").towards(CUP),
    TIP.axis("z", reference=np.eye(3)),
    Joints(("a", "b")).spare(TIP.pose, free=("a",), origin=np.array([0.1, -0.2])),
    Joints().beneath(TIP.pose, TIP.position, bend=0.3),
]


@pytest.mark.parametrize("view", VIEWS)
def test_views_come_back_equal(view):
    arrays: dict = {}
    found = json.loads(json.dumps(taken_apart(view, arrays)))
    kinds = {kind.__name__: kind for kind in (*files._VIEWS, Site, Object)}
    assert Reader(kinds, arrays, "file").read(found, View) == view


def test_what_is_no_value_is_refused():
    with pytest.raises(ArgumentError, match="a policy cannot hold"):
        taken_apart({"fit": print}, {})


def test_a_folder_that_exists_is_left_alone(learned, tmp_path):
    policy = Policy(*learned("MinimalIntervention"))
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "note").touch()
    with pytest.raises(RecordingError, match="exists and is not empty; give a new folder"):
        policy.save(tmp_path / "there")
    assert [file.name for file in (tmp_path / "there").iterdir()] == ["note"]


def test_what_fails_leaves_nothing(learned, tmp_path, monkeypatch):
    policy = Policy(*learned("MinimalIntervention"))

    def full(*_):
        raise OSError("disk full")

    monkeypatch.setattr(files, "write_text", full)
    with pytest.raises(RecordingError, match="disk full"):
        policy.save(tmp_path / "new")
    assert not any(tmp_path.iterdir())


def test_a_policy_that_was_read_is_copied_as_a_folder(folder_of, tmp_path):
    with pytest.raises(RecordingError, match="copy the folder instead"):
        Policy.load(folder_of("MinimalIntervention")).save(tmp_path / "new")


def edited(text, *keys, value):
    """JSON text with one entry changed, or removed where the value is None."""
    about = json.loads(text)
    inner = about
    for key in keys[:-1]:
        inner = inner[key]
    if value is None:
        del inner[keys[-1]]
    else:
        inner[keys[-1]] = value
    return json.dumps(about)


IN_RECIPE = ("policy", "content", "recipe")


@pytest.mark.parametrize(
    ("keys", "value", "words"),
    [
        (("schema",), 9, "is of schema 9; this is 5"),
        (("arrays",), "0", "is damaged or of another policy"),
        (("policy",), [], "a list is out of place"),
        (("policy", "kind"), "Popen", "unknown kind 'Popen'"),
        (("policy", "robot"), 3, "is out of place - at `$.robot`"),
        (("policy", "robot", "home"), None, "missing or unknown fields ['home']"),
        (("policy", "robot", "home"), {"array": "array-99"}, "'array-99' is missing"),
        (("policy", "robot", "home"), {"array": "array-0"}, "home has shape"),
        (("policy", "robot", "parents"), [5] * 14, "do not form a tree"),
        (("policy", "robot", "joints"), [1] * 14, "1 is out of place - at `$.robot.joints[0]`"),
        (("policy", "robot", "hands"), {"items": [["hand", "nowhere"]]}, "['nowhere'] are missing"),
        (("policy", "content", "period"), "soon", "'soon' is out of place"),
        (("policy", "content", "period"), -1.0, "period is -1.0"),
        ((*IN_RECIPE, "friction"), None, "missing or unknown fields ['friction']"),
        ((*IN_RECIPE, "friction"), True, "True is out of place"),
        ((*IN_RECIPE, "effort"), "Chaos", "'Chaos' is out of place"),
        ((*IN_RECIPE, "lasts"), 0.0, "lasts is 0.0"),
        ((*IN_RECIPE, "skills"), {"items": 3}, "what is mapped here is out of place"),
        ((*IN_RECIPE, "skills"), [], "there is no skill"),
        ((*IN_RECIPE, "skills", 0, "views"), {"items": []}, "0 views"),
        ((*IN_RECIPE, "skills", 0, "views", "items", 0, 1, "part"), "nose", "'nose' is out of"),
        ((*IN_RECIPE, "skills", 0, "views", "items", 0, 1, "site"), "nose", "no site 'nose'"),
        ((*IN_RECIPE, "skills", 0, "frames", 0, "kind"), "RobotFile", "RobotFile is out of place"),
    ],
)
def test_every_damage_is_named(keys, value, words, folder_of, tmp_path):
    folder = shutil.copytree(folder_of("MinimalIntervention"), tmp_path / "policy")
    text = (folder / files.POLICY).read_text()
    (folder / files.POLICY).write_text(edited(text, *keys, value=value))
    with pytest.raises(RecordingError) as error:
        Policy.load(folder)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_files_that_are_missing_or_cut_off(folder_of, tmp_path):
    with pytest.raises(RecordingError, match="holds no policy; give a folder that tpsim export"):
        Policy.load(tmp_path)
    folder = shutil.copytree(folder_of("MinimalIntervention"), tmp_path / "policy")
    content = (folder / files.ARRAYS).read_bytes()
    (folder / files.ARRAYS).write_bytes(content[:1000])
    with pytest.raises(RecordingError, match="damaged or of another policy"):
        Policy.load(folder)
    (folder / files.ARRAYS).unlink()
    with pytest.raises(RecordingError, match="there is no file"):
        Policy.load(folder)
    (folder / files.POLICY).write_text((folder / files.POLICY).read_text()[:500])
    with pytest.raises(RecordingError, match="is no JSON"):
        Policy.load(folder)


def test_nothing_in_it_is_a_pickle(folder_of):
    with np.load(folder_of("FiniteHorizon") / files.ARRAYS, allow_pickle=False) as arrays:
        assert all(arrays[name].dtype.kind in "fU" for name in arrays)


def test_the_command_writes_a_policy(tmp_path, capsys):
    folder = tmp_path / "policy"
    assert cli.main(["export", "cup", "--folder", str(folder), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["hands"] == ["left_hand", "right_hand"] and answer["objects"] == []
    assert Policy.load(folder).name == answer["task"] == "cup"
    assert cli.main(["export", "cup", "--folder", str(folder)]) == 1
    assert "give a new folder" in capsys.readouterr().err
