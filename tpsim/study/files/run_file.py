"""``run.json``: what a run says about itself, before it starts and when it is whole."""

import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from tpsim.robot.description import Description
from tpsim.study.files.about import TaskFile
from tpsim.versions import versions
from tpsim.world.threads import linear_algebra, one_thread

SCHEMA = 3
"""Version of the layout of ``run.json``."""

UNITS = {
    "time": "s",
    "q": "rad",
    "dq": "rad/s",
    "torque": "Nm",
    "torque_feedforward": "Nm",
    "position": "m",
    "quaternion": "1 (w, x, y, z)",
    "wrench": "N, Nm (world axes)",
    "point": "m",
    "stiffness": "N/m, Nm/rad",
    "damping": "N s/m, Nm s/rad",
    "reference": "m, rad",
    "stored": "J",
    "dissipated": "J",
    "injected": "J",
    "tank": "J",
}
"""Units of the signals, by name or by the last word of the name."""


@dataclass(frozen=True)
class Whole:
    """That a run has come to its end, and with what.

    Parameters
    ----------
    trials : int
        Number of trials in the folder.
    files : dict of str to str
        SHA-256 of scene, assets, trials and models, and of what ``demonstrations/`` say of
        themselves.
    record : str
        SHA-256 of ``run.json`` with nothing in this place.
    finished : str
        When.
    """

    trials: int
    files: dict[str, str]
    record: str
    finished: str


@dataclass(frozen=True)
class RunFile:
    """Content of ``run.json``.

    Parameters
    ----------
    schema : int
    command : str
        The command line that repeats the run.
    configuration : dict
        Every setting.
    seed : int
    started : str
        When.
    git_commit : str, optional
        Of the checkout that ran.
    versions : dict of str to str
    task : TaskFile
        The task, its fields, and where its study is from.
    robot : Description
        What ``scene.xml`` does not say about the robot.
    scene : str
        SHA-256 of ``scene.xml``.
    assets : dict of str to str
        SHA-256 of the files in ``assets/``.
    sites : tuple of str
        Of the scene.
    units : dict of str to str
    whole : Whole, optional
        None while it runs, and for ever after it was interrupted.
    """

    schema: int
    command: str
    configuration: dict[str, object]
    seed: int
    started: str
    git_commit: str | None
    versions: dict[str, str | None]
    task: TaskFile
    robot: Description
    scene: str
    assets: dict[str, str]
    sites: tuple[str, ...]
    units: dict[str, str]
    whole: Whole | None = None


def environment() -> dict[str, str | None]:
    """What the bits of a result depend on, besides the code that is run."""
    with one_thread():
        return versions(("tpsim", "numpy", "scipy", "mujoco", "pin")) | {"blas": linear_algebra()}


def differing(then: Mapping[str, str | None]) -> list[str]:
    """What has changed since then that bits depend on, in words."""
    here = environment()
    changed = sorted(n for n in then.keys() | here.keys() if then.get(n) != here.get(n))
    return [f"{name} {then.get(name)} then, {here.get(name)} now" for name in changed]


def now() -> str:
    """Date, time and zone of now."""
    return datetime.now().astimezone().isoformat(timespec="seconds")


def git_commit() -> str | None:
    """Commit of the checkout that runs, marked where files differ from it; None without git."""
    checkout = Path(__file__).parents[3]
    if not (checkout / "pyproject.toml").is_file():
        return None
    where = ["git", "-C", str(checkout)]
    try:
        answer = subprocess.run(
            [*where, "describe", "--always", "--abbrev=40", "--dirty", "--exclude=*"],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return answer.stdout.strip()
