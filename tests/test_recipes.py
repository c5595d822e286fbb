"""The recipes of the documentation run as they are printed."""

import re
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[1] / "docs" / "recipes"
BLOCK = re.compile(r"^```python\n(.*?)^```", re.M | re.S)
NAMES = ("robot", "task", "comparison-method", "controller", "view")


def blocks(name):
    return BLOCK.findall((FOLDER / f"{name}.md").read_text())


def run(name, folder, monkeypatch):
    """Save the code of a recipe as a reader would, and import it."""
    import importlib.util
    import sys

    monkeypatch.chdir(folder)
    file = folder / f"recipe_{name.replace('-', '_')}.py"
    file.write_text("\n".join(blocks(name)))
    spec = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, file.stem, module)
    spec.loader.exec_module(module)
    return module


def test_there_are_five_of_at_most_sixty_lines_each():
    assert sorted(path.stem for path in FOLDER.glob("*.md")) == sorted(NAMES)
    for name in NAMES:
        longest = max(len(block.splitlines()) for block in blocks(name))
        assert longest <= 60, f"{name}.md has {longest} lines"


def test_robot(tmp_path, monkeypatch):
    found = run("robot", tmp_path, monkeypatch)
    np.testing.assert_allclose(found.robot.torque_limit, [40, 60, 25])
    assert found.trial.outcome == "done"
    assert np.ptp(found.trial.pose("hand").position[:, 1]) > 0.005


def test_task(tmp_path, monkeypatch):
    found = run("task", tmp_path, monkeypatch)
    assert found.trial.outcome == "done" and np.linalg.norm(found.miss[:2]) < 0.01


def test_comparison_method(tmp_path, monkeypatch):
    pytest.importorskip("tpsim.section8")
    found = run("comparison-method", tmp_path, monkeypatch)
    rows = found.answer["methods"]
    assert rows["mine"]["end"] < 1e-3 and rows["mine"]["rms"] < 2 * rows["TP-GMR"]["rms"]


def test_controller(tmp_path, monkeypatch):
    from tpsim import lab

    found = run("controller", tmp_path, monkeypatch)
    robot, poses = found.task.stage.robot, _poses(found.trial)
    seen = [found.spring.view(robot.at(q, objects=poses)) for q in found.trial["q"]]
    angle = np.abs([s.value[0] for s in seen])
    assert found.trial.outcome == "done" and angle[0] > 0.2 and angle[-1] < 0.02
    soft = found.study.all_controllers["soft"](None, {}, found.situation)
    held = lab.perform(found.task, {}, found.situation, controller=soft, duration=0.3)
    np.testing.assert_allclose(held["q"], held["q"][0] + np.zeros_like(held["q"]), atol=1e-9)


def _poses(trial):
    from tpsim import lab

    poses = {name: trial.pose(name) for name in trial.channels.objects}
    return {name: lab.Pose(pose.rotation[0], pose.position[0]) for name, pose in poses.items()}


def test_view(tmp_path, monkeypatch):
    found = run("view", tmp_path, monkeypatch)
    state = found.robot.at(found.robot.home, objects=found.objects)
    J = found.near(state).jacobian
    assert np.abs(found.posture(state).jacobian @ J.T).max() < 1e-3
