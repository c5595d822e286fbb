"""Demonstrations and models in folders: taught and learned once, used by later commands."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from tpsim import paths
from tpsim.errors import RecordingError
from tpsim.study.files.run import Run, load_run, open_run
from tpsim.study.study import Study
from tpsim.task.task import Task
from tpsim.task.verbs import Taught
from tpsim.whole import check_free, newest, numbered_folder, whole_folder
from tpsim.world.trial import Trial


def write_demonstrations(
    folder: Path, study: Study, behaviour: str, trials: Sequence[Trial], *, seed: int, command: str
) -> Run:
    """Write the demonstrations of one behaviour as a run folder."""
    settings = {"behaviour": behaviour, "count": len(trials)}
    run = open_run(folder, study=study, command=command, configuration=settings, seed=seed)
    for index, trial in enumerate(trials):
        run.save(index, trial)
    return run.finish()


def read_demonstrations(task: Task, folder: Path | None = None) -> Taught:
    """Demonstrations of every behaviour of a task.

    Parameters
    ----------
    task : Task
    folder : Path, optional
        Holds a run folder for each behaviour; by default those in
        ``recordings/demonstrations`` that were taught last.

    Raises
    ------
    RecordingError
        If some are missing, were interrupted or changed, or show another robot.
    """
    taught = {}
    for behaviour in task.behaviours():
        where = _place(folder, behaviour)
        if not (where / "run.json").is_file():
            raise RecordingError(
                f"there are no demonstrations of '{behaviour}' in {where}; record some with "
                "tpsim teach, and name the folder that it was given"
            )
        run = load_run(where).check()
        if run.file.whole is None:
            raise RecordingError(f"teaching was interrupted in {where}; teach it again")
        if run.file.robot.joints != task.stage.robot.joints:
            raise RecordingError(
                f"{where} shows a robot with joints {', '.join(run.file.robot.joints)}; task "
                f"'{task.name}' has {', '.join(task.stage.robot.joints)}: teach it in a folder of "
                "its own"
            )
        taught[behaviour] = list(run.trials())
    return taught


def check_place(task: Task, folder: Path | None, behaviour: str) -> None:
    """Look whether new demonstrations of a behaviour can be written.

    Raises
    ------
    RecordingError
        If the given folder holds something, or the usual one those of another robot.
    """
    if folder is not None:
        check_free(folder / behaviour)
    elif _shows_another_robot(there := _place(None, behaviour), task):
        raise RecordingError(f"{there} holds demonstrations of another robot; give --folder")


def add_demonstrations(
    folder: Path | None,
    study: Study,
    behaviour: str,
    trials: Sequence[Trial],
    *,
    seed: int,
    command: str,
) -> Path:
    """Write demonstrations whole or not at all; return their folder.

    It is ``<folder>/<behaviour>``, which must be new; or in ``recordings/demonstrations`` the next
    of ``<behaviour>``, ``<behaviour>~2``, ..., of which the last is read.
    """
    write = partial(
        write_demonstrations,
        study=study,
        behaviour=behaviour,
        trials=trials,
        seed=seed,
        command=command,
    )
    if folder is None:
        return numbered_folder(paths.demonstrations(behaviour), write)
    with whole_folder(folder / behaviour) as new:
        write(new)
    return folder / behaviour


def _shows_another_robot(folder: Path, task: Task) -> bool:
    try:
        return load_run(folder).file.robot.joints != task.stage.robot.joints
    except RecordingError:  # nothing, or of an older schema and of no use to anybody
        return False


def _place(folder: Path | None, behaviour: str) -> Path:
    if folder is None:
        return newest(paths.demonstrations(behaviour))
    # The folder of the behaviour itself, as tpsim teach prints it, is understood too.
    itself = folder.name == behaviour and (folder / "run.json").is_file()
    return folder if itself else folder / behaviour
