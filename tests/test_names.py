"""What is for every robot names none."""

import re
from pathlib import Path

import tpsim
from tpsim.catalogue.robots import CATALOGUE

ROOMS = ("robot", "world", "controllers", "scene", "film", "task", "study")


def test_no_robot_is_named_where_all_are_meant():
    names = "|".join(name for name in CATALOGUE if not name.startswith("planar"))
    words = re.compile(rf"\b({names}|kinova|franka|panda|aloha)\b", re.IGNORECASE)
    package = Path(tpsim.__file__).parent
    found = [
        f"{path.relative_to(package)}:{number}: {line.strip()}"
        for room in ROOMS
        for path in sorted((package / room).rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if words.search(line)
    ]
    assert found == []
