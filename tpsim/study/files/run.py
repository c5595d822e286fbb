"""Run folders: one run, one folder that says how to repeat it.

``run.json``, ``scene.xml`` and ``assets/`` are written before the run starts; a file that has its
name is complete, and nothing is overwritten.
"""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from pathlib import Path

from tpsim import npz, paths
from tpsim.errors import RecordingError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.study.files import limits
from tpsim.study.files.about import TaskFile
from tpsim.study.files.checked import from_json, plain, to_json
from tpsim.study.files.inside import (
    checksum,
    checksum_inside,
    inside,
    inside_folder,
    read_text_inside,
)
from tpsim.study.files.models_file import load_models, model_files, save_models
from tpsim.study.files.run_file import SCHEMA, UNITS, RunFile, Whole, environment, git_commit, now
from tpsim.study.files.scene import ASSETS, SCENE, read_world, write_world
from tpsim.study.files.trial_file import load_trial, save_trial
from tpsim.study.study import Study
from tpsim.task.task import Models
from tpsim.whole import removed_if_nothing_came, write_text
from tpsim.world.trial import Trial
from tpsim.world.world import World

_FILE = "run.json"

DEMONSTRATIONS = "demonstrations"
"""Folder in that of a run, with a run folder for each behaviour that was taught."""


@dataclass(frozen=True)
class Run:
    """A run folder.

    Parameters
    ----------
    folder : Path
    file : RunFile
        The content of ``run.json``.
    """

    folder: Path
    file: RunFile

    def path(self, index: int) -> Path:
        """File of trial ``index``."""
        return self.folder / f"trial-{index:06d}.npz"

    def save(self, index: int, trial: Trial) -> Path:
        """Write trial ``index``; RecordingError if there is one."""
        return save_trial(self.path(index), trial)

    def load(self, index: int) -> Trial:
        """Read trial ``index``."""
        return load_trial(inside(self.folder, self.path(index).name))

    def save_models(self, models: Models) -> list[Path]:
        """Write the models; RecordingError if there are some."""
        return save_models(self.folder, models)

    def files(self) -> tuple[Path, ...]:
        """The trials' files, in order.

        Raises
        ------
        RecordingError
            If one has no number.
        """
        return tuple(sorted(self.folder.glob("trial-*.npz"), key=number_of))

    def trials(self, files: Sequence[Path] | None = None) -> Iterator[Trial]:
        """Read the trials, or those of some files, one after the other."""
        some = self.files() if files is None else files
        return (load_trial(inside(self.folder, file.name)) for file in some)

    @cached_property
    def world(self) -> World:
        """The world of the run, from the files of the folder alone.

        Raises
        ------
        RecordingError
            If the scene or its files were changed, or ask for anything outside the folder.
        """
        return read_world(self.folder, self.file.robot, self.file.scene, self.file.assets)

    @cached_property
    def models(self) -> dict[str, TPGMM]:
        """What was learned, by behaviour.

        Raises
        ------
        RecordingError
            If a file is no model, or was changed after the run.
        """
        models = load_models(self.folder)
        if self.file.whole is not None:
            of_models = (name for name in self.file.whole.files if name.startswith("model-"))
            names = {*of_models, *(file.name for file in model_files(self.folder).values())}
            self._refuse([name for name in self.changed() if name in names])
        return models

    def changed(self) -> list[str]:
        """Files that are not those of the run when it came to its end; none while it runs.

        ``run.json`` is one of them where anything that it says was changed.
        """
        whole = self.file.whole
        if whole is None:
            return []
        now = _checksums(self.folder)
        names = sorted(now.keys() | whole.files.keys())
        changed = [name for name in names if now.get(name) != whole.files.get(name)]
        return changed if _sealed(self.file, whole) == self.file else [_FILE, *changed]

    def check(self) -> "Run":
        """Raise RecordingError if anything was changed since the run came to its end."""
        self._refuse(self.changed())
        return self

    def _refuse(self, changed: list[str]) -> None:
        if changed:
            names = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" * (len(changed) > 3))
            raise RecordingError(
                f"{names} in {self.folder}: changed after the run; restore it or record again"
            )

    def finish(self) -> "Run":
        """State in ``run.json`` that the run is whole: how many trials, which models.

        Raises
        ------
        RecordingError
            If it was finished before, or a trial between others is missing.
        """
        files = self.files()
        if self.file.whole is not None:
            raise RecordingError(f"{self.folder} was finished before")
        if files != tuple(self.path(index) for index in range(len(files))):
            raise RecordingError(f"a trial between others is missing in {self.folder}")
        done = _sealed(self.file, Whole(len(files), _checksums(self.folder), "", now()))
        write_text(self.folder / _FILE, _text(done), replace=True)
        return Run(self.folder, done)


def number_of(file: Path) -> int:
    """Number of a trial's file."""
    number = file.stem.removeprefix("trial-")
    if not re.fullmatch(r"\d{6,9}", number, re.ASCII):
        raise RecordingError(f"{file} has no number; trials are trial-000000.npz and so on")
    return int(number)


def run_folder(task: str, seed: int) -> Path:
    """Make a new folder in ``recordings/runs``: ``<task>-<YYYYMMDD-HHMMSS>-seed<k>``."""
    name, count = f"{task}-{datetime.now():%Y%m%d-%H%M%S}-seed{seed}", 1
    paths.runs().mkdir(parents=True, exist_ok=True)
    while True:
        folder = paths.runs() / (name if count == 1 else f"{name}-{count}")
        try:
            folder.mkdir()
        except FileExistsError:
            count += 1
        else:
            return folder


def open_run(
    folder: Path,
    *,
    study: Study,
    command: str,
    configuration: Mapping[str, object],
    seed: int,
) -> Run:
    """Make a run folder, and write all but results before anything runs.

    Parameters
    ----------
    folder : Path
        A folder that does not exist or is empty.
    study : Study
        Its task's world and fields, and its reference, are written.
    command : str
        The command line that repeats the run.
    configuration : mapping
        Every setting.
    seed : int
        Seed of the run.

    Raises
    ------
    RecordingError
        If the folder holds something already, also if another process just took it.
    """
    folder, world = Path(folder), study.task.stage
    task, settings = TaskFile.of(study), plain(dict(configuration))
    assert isinstance(settings, dict)
    _claim(folder)
    with removed_if_nothing_came(folder):
        scene, assets = write_world(folder, world)
        file = RunFile(
            SCHEMA,
            command,
            settings,
            seed,
            now(),
            git_commit(),
            environment(),
            task,
            world.description,
            scene,
            assets,
            tuple(world.model.site(i).name for i in range(world.model.nsite)),
            UNITS,
        )
        write_text(folder / _FILE, _text(file))
    return Run(folder, file)


def load_run(folder: Path) -> Run:
    """Read a run folder.

    Raises
    ------
    RecordingError
        Names file and field: ``run.json`` is missing, broken or of another schema.
    """
    folder = Path(folder)
    where = folder / _FILE
    text = read_text_inside(folder, _FILE, limits.TEXT)
    found = from_json(text, dict, where)
    if found.get("schema") != SCHEMA:
        raise RecordingError(
            f"{where} has schema {found.get('schema')!s:.20}, this tpsim reads {SCHEMA}; "
            "record the run again"
        )
    file = from_json(text, RunFile, where)
    return Run(folder, file)


def _claim(folder: Path) -> None:
    """Take a folder for this run, so that no other process can."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.listdir(folder):
            (folder / SCENE).touch(exist_ok=False)
            return
    except FileExistsError:
        pass
    except OSError as error:
        raise RecordingError(f"cannot make {folder} ({error.strerror})") from None
    raise RecordingError(
        f"{folder} exists and is not an empty folder; give a new one, recordings are never "
        "overwritten"
    )


def _text(file: RunFile) -> str:
    return to_json(file, indent=2) + "\n"


def _sealed(file: RunFile, whole: Whole) -> RunFile:
    """What run.json says, with the checksum of it."""
    blank = replace(file, whole=replace(whole, record=""))
    return replace(file, whole=replace(whole, record=checksum(_text(blank).encode())))


def _checksums(folder: Path) -> dict[str, str]:
    names = [file.name for kind in ("trial-*.npz", "model-*.npz") for file in folder.glob(kind)]
    sums = {SCENE: checksum_inside(folder, SCENE, limits.TEXT)}
    for file in sorted((folder / ASSETS).glob("*")):
        sums[f"{ASSETS}/{file.name}"] = checksum_inside(folder / ASSETS, file.name, limits.ASSETS)
    taught = [file.parent for file in folder.glob(f"{DEMONSTRATIONS}/*/{_FILE}")]
    sums |= {name: checksum_inside(folder, name, npz.BYTES) for name in sorted(names)}
    for shown in sorted(taught):
        inside_folder(folder, shown)
        name = shown.relative_to(folder).as_posix()
        sums[f"{name}/{_FILE}"] = checksum_inside(shown, _FILE, limits.TEXT)
    return sums
