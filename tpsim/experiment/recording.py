"""Recordings: one run, one folder that says how to repeat it.

``run.json`` and ``scene.xml`` are written before the run starts; a file that has its name is
complete.
"""

import hashlib
import json
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from tpsim import paths
from tpsim.errors import RecordingError
from tpsim.experiment.doctor import versions
from tpsim.experiment.summary import plain
from tpsim.experiment.trial_file import SCHEMA
from tpsim.experiment.trial_file import load_trial as load_trial
from tpsim.experiment.trial_file import save_trial as save_trial
from tpsim.sim.trial import Trial
from tpsim.whole import write_text

UNITS = {
    "time": "s",
    "q": "rad",
    "dq": "rad/s",
    "torque": "Nm",
    "torque_feedforward": "Nm",
    "position": "m",
    "quaternion": "1 (w, x, y, z)",
    "wrench": "N, Nm (world axes)",
    "stiffness": "N/m, Nm/rad",
    "damping": "N s/m, Nm s/rad",
    "reference": "m, rad",
}
"""Units of the signals, by name or by the last word of the name."""


@dataclass(frozen=True)
class Run:
    """A run folder: ``run.json``, ``scene.xml`` and the trials.

    Parameters
    ----------
    folder : Path
        Where the files are.
    description : dict
        The content of ``run.json``.
    """

    folder: Path
    description: dict[str, Any]

    def path(self, index: int) -> Path:
        """Return the file of trial ``index``."""
        return self.folder / f"trial-{index:06d}.npz"

    def save(self, index: int, trial: Trial) -> Path:
        """Write trial ``index``."""
        return save_trial(self.path(index), trial)

    def load(self, index: int) -> Trial:
        """Read trial ``index``."""
        return load_trial(self.path(index))

    @property
    def scene(self) -> str:
        """MJCF of the scene, checked against the checksum that was taken before the run."""
        xml = _read(self.folder / "scene.xml")
        if _checksum(xml) != self.description["scene_sha256"]:
            raise RecordingError(
                f"{self.folder / 'scene.xml'} was changed after the run; restore it or record again"
            )
        return xml

    def files(self) -> tuple[Path, ...]:
        """Return the trials' files in order."""
        return tuple(sorted(self.folder.glob("trial-*.npz")))

    def trials(self) -> Iterator[Trial]:
        """Read the trials one after the other."""
        return map(load_trial, self.files())


def run_folder(task: str, seed: int) -> Path:
    """Return a new name in ``recordings/runs``: ``<task>-<YYYYMMDD-HHMMSS>-seed<k>``."""
    name = f"{task}-{datetime.now():%Y%m%d-%H%M%S}-seed{seed}"
    folder = paths.runs() / name
    count = 1
    while folder.exists():
        count += 1
        folder = paths.runs() / f"{name}-{count}"
    return folder


def open_run(
    folder: Path,
    *,
    command: str,
    configuration: Mapping[str, Any],
    seed: int,
    scene_xml: str,
    model: Any,
) -> Run:
    """Make a run folder and write ``run.json`` and ``scene.xml`` before anything runs.

    Parameters
    ----------
    folder : Path
        A folder that does not exist or is empty.
    command : str
        The command line that repeats the run.
    configuration : mapping
        Every setting; dataclasses, arrays and paths become plain JSON values.
    seed : int
        Seed of the run.
    scene_xml : str
        The scene as MJCF.
    model : mujoco.MjModel
        The compiled scene, for the names of its joints and sites.

    Raises
    ------
    RecordingError
        Where the folder holds something already.
    """
    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise RecordingError(
            f"{folder} exists and is not an empty folder; give a new one, "
            "recordings are never overwritten"
        )
    description = plain(
        {
            "schema": SCHEMA,
            "command": command,
            "configuration": configuration,
            "seed": seed,
            "started": datetime.now().astimezone().isoformat(timespec="seconds"),
            "git_commit": _git_commit(),
            "versions": versions(("tpsim", "numpy", "scipy", "mujoco", "pin")),
            "scene_sha256": _checksum(scene_xml),
            "joints": [model.joint(i).name for i in range(model.njnt)],
            "sites": [model.site(i).name for i in range(model.nsite)],
            "units": UNITS,
        }
    )
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "scene.xml", scene_xml)
    write_text(folder / "run.json", json.dumps(description, indent=2) + "\n")
    return Run(folder, description)


def load_run(folder: Path) -> Run:
    """Read a run folder.

    Raises
    ------
    RecordingError
        Where ``run.json`` is missing, broken or of another schema.
    """
    folder = Path(folder)
    file = folder / "run.json"
    try:
        description = json.loads(_read(file))
    except json.JSONDecodeError as error:
        raise RecordingError(f"{file} is no JSON ({error}); record the run again") from None
    if not isinstance(description, dict) or description.get("schema") != SCHEMA:
        raise RecordingError(f"{file} is not of schema {SCHEMA}; record the run again")
    return Run(folder, description)


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot read {path} ({error}); give the folder of a run") from None


def _checksum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _git_commit() -> str | None:
    """Commit of the checkout that runs, marked where files differ from it; None without git."""
    checkout = Path(__file__).parents[2]
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
