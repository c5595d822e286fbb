"""The command tune: gains of the experts that a task is compared with."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tpsim.cli.options import MANY, Answer, StudyCommand, number
from tpsim.versions import cores

if TYPE_CHECKING:
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Tune(StudyCommand):
    """Tune the experts that a task is compared with, and write their gains."""

    trials: int = 30
    """Sets of gains that are tried for each expert."""
    seed: int = 10_000
    """Seed of gains and situations; from 10000 on, which no comparison uses."""
    only: tuple[str, ...] = ()
    """Experts to tune (default: all); the others keep their gains."""
    workers: int | None = None
    """Number of processes (default: one per core)."""

    def check(self) -> None:
        """Check the counts."""
        super().check()
        number("--trials", self.trials, 1, MANY)
        if self.workers is not None:
            number("--workers", self.workers, 1, MANY)

    def execute(self, study: "Study", line: str) -> Answer:
        """Tune the experts; without a folder, the gains that the task brings are replaced."""
        from tpsim.study.tuning import tune

        return tune(
            study,
            trials=self.trials,
            seed=self.seed,
            file=None if self.folder is None else self.folder / "gains.json",
            workers=self.workers or cores(),
            only=self.only,
            command=line,
        )
