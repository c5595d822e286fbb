"""What happened in the playground as ordinary recordings, written whole or not at all."""

import shutil
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from tpsim import paths
from tpsim.errors import ArgumentError
from tpsim.play.recording import Recorded
from tpsim.play.session import HOLD
from tpsim.study.files.about import Led, Performed, TaskFile
from tpsim.study.files.checked import plain
from tpsim.study.files.run import DEMONSTRATIONS, Run, open_run
from tpsim.study.study import Study
from tpsim.study.teaching_files import write_demonstrations
from tpsim.task.task import Models
from tpsim.whole import numbered_folder, whole_folder
from tpsim.world.trial import Trial


class Shelf:
    """The folder of one session.

    ``demonstrations/<behaviour>`` are what ``tpsim learn TASK --demonstrations`` takes;
    ``played``, ``played~2``, ... are run folders of one performance each, for ``tpsim replay``.

    Parameters
    ----------
    name : str
        Of the task.
    folder : Path, optional
        Made when the first thing is kept; by default one of this moment in ``recordings/played``.
    command : str
        For people who read the folder.
    """

    def __init__(self, name: str, folder: Path | None = None, command: str = ""):
        stamp = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
        self.folder = paths.recordings() / "played" / stamp if folder is None else folder
        self._command = command
        self._written: set[Path] = set()

    def keep_demonstrations(
        self, study: Study, behaviour: str, shown: Sequence[Recorded], seed: int = 0
    ) -> Path:
        """Write all demonstrations of a behaviour that were kept up to now.

        Raises
        ------
        RecordingError
            If the folder cannot be written; what was there stays.
        """
        place = self.folder / DEMONSTRATIONS / behaviour
        trials = [_about(recorded, study) for recorded in shown]
        new, old = (place.with_name(f".{behaviour}-{name}") for name in ("new", "old"))
        if not trials:
            if place in self._written:
                shutil.rmtree(place)
                self._written.discard(place)
            return place
        shutil.rmtree(new, ignore_errors=True)
        with whole_folder(new) as fresh:
            write_demonstrations(fresh, study, behaviour, trials, seed=seed, command=self._command)
        # Only what this session wrote gives way.
        if place in self._written:
            place.rename(old)
        with whole_folder(place) as there:
            there.rmdir()
            new.rename(there)
        shutil.rmtree(old, ignore_errors=True)
        self._written.add(place)
        return place

    def keep_performance(
        self, study: Study, models: Models, recorded: Recorded, seed: int = 0
    ) -> Path:
        """Write a performance as a run folder that ``tpsim replay`` repeats bit for bit."""
        if recorded.behaviour or recorded.condition.controller == HOLD:
            raise ArgumentError("that is no performance of a controller; it cannot be kept as one")

        def fill(folder: Path) -> Run:
            run = open_run(
                folder,
                study=study,
                command=self._command,
                configuration={"played": True},
                seed=seed,
            )
            run.save_models(models)
            run.save(0, _about(recorded, study))
            return run.finish()

        return numbered_folder(self.folder / "played", fill)


def _about(recorded: Recorded, study: Study) -> Trial:
    """The trial, saying how it is repeated."""
    if recorded.behaviour:
        about = plain(Led(recorded.behaviour, recorded.condition))
        outcome = None
    else:
        about = plain(Performed(recorded.condition, TaskFile.of(study)))
        outcome = study.task.outcome(recorded.trial)
    assert isinstance(about, dict)
    return recorded.trial.with_about(outcome, **about)
