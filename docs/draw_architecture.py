"""Draw docs/architecture.png from the imports: rooms as boxes on their floors, imports as arrows.

Run it after rooms have moved: ``make architecture``. It reads the source with ``ast`` alone.
"""

import ast
from collections import Counter
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyBboxPatch

PACKAGE = Path(__file__).resolve().parents[1] / "tpsim"
FLOORS = (
    ("values",),
    ("learning",),
    ("retrieval", "control"),
    ("robot",),
    ("world",),
    ("controllers",),
    ("scene", "film", "catalogue"),
    ("task",),
    ("study",),
    ("tasks", "deploy"),
    ("campaign",),
    ("lab", "section8", "data", "bench", "plot", "gallery"),
    ("play",),
    ("cli",),
)
WHAT = {
    "values": "Demonstration, Frame, Gaussian, Pose",
    "learning": "TP-GMM, HMM, structures, selection",
    "retrieval": "GMR, trajectory, GP, ProMP, DMP",
    "control": "LQT, impedance, Table 3",
    "robot": "intake, Robot, State, views",
    "world": "plant, people, teaching, roll-out",
    "controllers": "learned ones, ones to compare with",
    "scene": "parts, light, cameras",
    "film": "clips, video",
    "task": "Task, situations, teach, learn, perform",
    "study": "conditions, measures, run, replay, report",
    "tasks": "cup and sugar, pointing, tracking, transfer",
    "deploy": "policies for real arms",
    "lab": "all of it, flat",
    "campaign": "thousands of trials",
    "section8": "the comparison",
    "data": "files of users",
    "bench": "speeds",
    "plot": "figures",
    "gallery": "the demos",
    "catalogue": "robots by name",
    "play": "teach, push and watch in the browser",
    "cli": "the command line",
}


_BOX = {"fc": "#f4f6f8", "ec": "#20364c", "lw": 1.0}


_GAP = 0.9
_LETTER = 0.165  # width of a letter, in units of the picture


def width(room: str) -> float:
    """Width of a box that holds its words."""
    return _LETTER * max(len(WHAT[room]), len(room) + 3)


def room_of(module: str) -> str:
    """Room of ``tpsim.a.b``."""
    name = [*module.split("."), ""][1]
    return name if name in WHAT or (PACKAGE / name).is_dir() else "values"


def arrows() -> Counter[tuple[str, str]]:
    """Number of imports from one room to another."""
    found: Counter[tuple[str, str]] = Counter()
    for path in PACKAGE.rglob("*.py"):
        if path == PACKAGE / "__init__.py":
            continue  # it shows the mathematics flat
        module = ".".join(["tpsim", *path.relative_to(PACKAGE).with_suffix("").parts])
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("tpsim"):
                pair = room_of(module), room_of(node.module or "")
                found[pair] += pair[0] != pair[1]
    return +found


def direct(found: Counter[tuple[str, str]]) -> set[tuple[str, str]]:
    """Arrows that no chain of others implies: enough to follow the walk, few enough to see."""
    height = {room: k for k, floor in enumerate(FLOORS) for room in floor}
    down = {(a, b) for a, b in found if height.get(a, -1) > height.get(b, 99)}

    def reaches(start: str, end: str, skip: tuple[str, str]) -> bool:
        nexts = {b for a, b in down if a == start and (a, b) != skip}
        return end in nexts or any(reaches(middle, end, skip) for middle in nexts)

    return {arrow for arrow in down if not reaches(*arrow, skip=arrow)}


def draw(path: Path) -> None:
    """Write the picture."""
    there = {room_of(f"tpsim.{p.stem}") for p in PACKAGE.iterdir()} | {"values"}
    place: dict[str, tuple[float, float]] = {}
    height = 0.0
    for floor in FLOORS:
        rooms = [room for room in floor if room in there]
        x = -sum(width(room) + _GAP for room in rooms) / 2
        for room in rooms:
            place[room] = (x + (width(room) + _GAP) / 2, height)
            x += width(room) + _GAP
        height += 1.25 if rooms else 0.0
    figure, axis = plt.subplots(figsize=(11, 10.5))
    for one, other in direct(arrows()):
        if one in place and other in place:
            straight = abs(place[one][1] - place[other][1]) < 2.0
            arrow = {
                "arrowstyle": "-|>",
                "color": "#5b7a99",
                "lw": 1.3,
                "shrinkA": 16,
                "shrinkB": 16,
                "connectionstyle": f"arc3,rad={0.0 if straight else 0.35}",
            }
            axis.annotate("", place[other], place[one], arrowprops=arrow, zorder=1)
    for room, (x, y) in place.items():
        name = room if room == "values" else f"{room}/"
        axis.text(x, y + 0.13, name, ha="center", va="center", fontsize=10, weight="bold", zorder=3)
        axis.text(x, y - 0.17, WHAT[room], ha="center", va="center", fontsize=8.5, zorder=3)
        wide = width(room)
        axis.add_patch(
            FancyBboxPatch(
                (x - wide / 2, y - 0.24), wide, 0.48, boxstyle="round,pad=0.09", zorder=2, **_BOX
            )
        )
    wide = max(abs(x) + width(room) / 2 for room, (x, _) in place.items()) + 0.3
    axis.set_xlim(-wide, wide)
    axis.set_ylim(-0.6, height - 0.4)
    axis.axis("off")
    axis.set_title(
        "A room imports lower floors only. An arrow is an import that no other arrows imply.",
        fontsize=10,
    )
    figure.savefig(path, dpi=110, bbox_inches="tight")


if __name__ == "__main__":
    draw(Path(__file__).with_name("architecture.png"))
