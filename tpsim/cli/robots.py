"""The command robots: what robots are at hand, and one of them closely."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from tyro.conf import Positional, arg

from tpsim.cli.options import Answer, Command, writable
from tpsim.errors import ArgumentError, RenderingError

if TYPE_CHECKING:
    from tpsim.catalogue.entry import Entry
    from tpsim.robot.robot import Robot


@dataclass(frozen=True, kw_only=True)
class Robots(Command):
    """List the robots at hand, or show one: limits, reach, load at home, changes."""

    name: Annotated[Positional[str | None], arg(metavar="[NAME]")] = None
    """Name, menagerie:NAME, or a file of yours; none lists them."""
    folder: Path | None = None
    """Folder for the picture of a robot (default: recordings/runs/robots)."""

    def check(self) -> None:
        """Check the folder."""
        writable("--folder", self.folder)
        if self.folder is not None and self.name is None:
            raise ArgumentError("--folder is for the picture of one robot: give its name, too")

    def execute(self) -> Answer:
        """List all, or show one."""
        from tpsim.catalogue import menagerie
        from tpsim.catalogue.robots import CATALOGUE, PREFIX, entry

        if self.name is not None:
            return _shown(entry(self.name), self.folder)
        arms = menagerie.names()
        more = (
            f"{PREFIX}NAME for {', '.join(arms)}"
            if arms
            else f"{PREFIX}NAME, with pip install {menagerie.PACKAGE}"
        )
        return {
            "robots": [_line(each) for each in CATALOGUE.values()],
            "menagerie": more,
            "yours": "an .xml or .urdf file, or my_arms.py:name",
        }


def _line(found: "Entry") -> str:
    """A robot in one line."""
    if not found.is_at_hand:
        return f"{found.name}: {found.title}; missing: pip install {found.package}"
    robot = found.robot()
    limits = sorted({float(limit) for limit in robot.torque_limit}, reverse=True)
    return (
        f"{found.name}: {found.title}; {robot.n} joints, hands {', '.join(robot.hands)}, "
        f"{'/'.join(f'{limit:g}' for limit in limits)} Nm; {found.licence}"
    )


def _shown(found: "Entry", folder: Path | None) -> Answer:
    """Everything about one robot."""
    from tpsim.robot import anatomy

    robot = found.robot()
    load = np.abs(robot.at_home.gravity)
    answer: dict[str, object] = {
        "robot": f"{found.name}: {found.title}",
        "licence": found.licence or "yours",
        "hands": [
            f"{hand} at {site}, reaches {anatomy.length(robot, site):.2f} m, holds "
            f"{anatomy.strength(robot, site, robot.home):.0f} N at home whatever its direction"
            for hand, site in robot.hands.items()
        ],
        "joints": [
            f"{joint}: {_range(robot, i)}, {robot.torque_limit[i]:g} Nm, "
            f"{_number(robot.velocity_limit[i])} rad/s, home {robot.home[i]:.2f} rad, holds "
            f"{load[i]:.2g} Nm there ({100 * load[i] / robot.torque_limit[i]:.0f} %), "
            f"friction {robot.friction[i]:g} Nm, damping {robot.damping[i]:g} Nms/rad"
            for i, joint in enumerate(robot.joints)
        ],
        "changes": list(robot.changes) or ["none"],
    }
    return answer | {"paths": {"picture": _picture(robot, found.name, folder)}}


def _range(robot: "Robot", i: int) -> str:
    if not np.isfinite(robot.upper[i]):
        return "no limits"
    return f"{robot.lower[i]:.2f} to {robot.upper[i]:.2f} rad"


def _number(value: float) -> str:
    return f"{value:g}" if np.isfinite(value) else "any"


def _picture(robot: "Robot", name: str, folder: Path | None) -> Path | None:
    """Picture of a robot at home; None where nothing draws."""
    from tpsim.film.clip import Clip
    from tpsim.film.video import still
    from tpsim.paths import recordings
    from tpsim.scene.bounds import box
    from tpsim.scene.compose import world

    place = recordings() / "runs" / "robots" if folder is None else folder
    place.mkdir(parents=True, exist_ok=True)
    file = Path(name).name.replace(":", "-")
    lowest = float(box(robot)[0][2])
    clip = Clip(world(robot, floor=lowest), np.zeros(1), robot.home[None])
    try:
        return still(clip, 0.0, place / f"{file}.png")
    except RenderingError:
        return None
