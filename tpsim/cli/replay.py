"""The command replay: whether runs, campaigns and single trials come out again, bit for bit."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import FlagCreatePairsOff, Positional, arg

from tpsim.cli.options import Answer, Command
from tpsim.errors import ArgumentError, RenderingError
from tpsim.versions import cores

if TYPE_CHECKING:
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Replay(Command):
    """Repeat a recorded run from its own folder and compare the recordings bit for bit.

    So for a campaign, or for one trial of either; a single trial of a campaign is filmed, too.
    """

    folder: Annotated[Positional[Path], arg(metavar="FOLDER|TRIAL")]
    """Run folder, with its run.json; folder of a campaign; or the file of one trial."""
    trial: tuple[int, ...] = ()
    """Numbers of trials of a campaign (default: all)."""
    compare: Annotated[FlagCreatePairsOff[bool], arg(name="check")] = False
    """Compare only: no film."""
    study: str | None = None
    """Study that was run, where it is none of the built-in ones: my_task.py:study."""
    workers: int | None = None
    """Number of processes (default: one per core)."""

    def execute(self) -> Answer:
        """Perform the recorded trials again."""
        from tpsim.study.files.run import load_run
        from tpsim.study.reference import load_study
        from tpsim.study.replay import replay

        study = None if self.study is None else load_study(self.study)
        if (found := self._campaign()) is not None:
            return self._of_campaign(*found, study)
        if self.trial:
            raise ArgumentError(f"--trial: {self.folder} is no campaign; give a trial's file")
        if self.folder.suffix != ".npz":
            return replay(load_run(self.folder), study, self._workers)
        return replay(load_run(self.folder.parent), study, only=self.folder)

    def exit_code(self, answer: Answer) -> int:
        """0 where all of a whole run is there, unchanged, and came out again."""
        return 0 if answer["repeats"] else 1

    @property
    def _workers(self) -> int:
        return self.workers or cores()

    def _campaign(self) -> tuple[Path, tuple[int, ...]] | None:
        """Folder of the campaign that is meant, and numbers of its trials."""
        if (self.folder / "campaign.json").is_file():
            return self.folder, self.trial
        above = self.folder.absolute().parents
        if len(above) > 2 and (above[2] / "campaign.json").is_file():
            from tpsim.study.files.run import number_of

            return above[2], (number_of(self.folder),)
        return None

    def _of_campaign(self, where: Path, numbers: tuple[int, ...], study: "Study | None") -> Answer:
        from tpsim.campaign.folder import load_folder
        from tpsim.campaign.replay import film_of, replay

        folder = load_folder(where)
        answer = replay(folder, numbers, study, self._workers)
        if len(numbers) != 1 or self.compare:
            return answer
        try:
            return {**answer, "paths": {"film": str(film_of(folder, numbers[0], study))}}
        except RenderingError as error:
            return {**answer, "no_film": str(error)}
