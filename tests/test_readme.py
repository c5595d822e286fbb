"""The README's example runs as it stands there, and on the page of environments."""

import re
from pathlib import Path

import numpy as np

README = Path(__file__).parent.parent / "README.md"


def test_the_twelve_lines_run():
    (code,) = re.findall(r"## Twelve lines\n\n```python\n(.*?)```", README.read_text(), re.DOTALL)
    lines = [line for line in code.splitlines() if line.strip()]
    assert len(lines) == 12
    names = {}
    exec(code, names)
    assert names["path"].mean.shape == (200, 2)
    assert names["controller"].gain.shape == (200, 2, 4)
    error = np.linalg.norm(names["plan"].states[:, :2] - names["path"].mean, axis=1)
    assert np.median(error) < 0.1


def test_another_agent_drives_a_task(capsys):
    page = README.parent / "docs" / "environments.md"
    (code,) = re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)
    exec(code, {})
    assert "25 steps of 0.02 s, reward" in capsys.readouterr().out
