"""The command run: the whole job of a study."""

import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from tyro.conf import FlagCreatePairsOff

from tpsim.cli.options import MANY, Answer, SeededCommand, number
from tpsim.versions import cores

if TYPE_CHECKING:
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Run(SeededCommand):
    """Teach, learn, reproduce, push, film and report: the whole job of a task."""

    video: bool = True
    """Film the trials (needs an offscreen renderer: see tpsim doctor)."""
    situations: int = 10
    """Number of situations that were never taught."""
    pushes: int = 6
    """Number of pushes in each situation."""
    teachers: int = 1
    """Number of teachers, each with demonstrations and situations of its own (see --seed)."""
    workers: int | None = None
    """Number of processes (default: one per core)."""
    plants: tuple[str, ...] = ()
    """Plants unlike the model on which the pushed trials are repeated, beside the nominal ones:
    names such as "friction 0.5 Nm", or all."""
    experts: bool = True
    """Perform the same pushes with controllers that people set by hand, where the task has such."""
    quick: FlagCreatePairsOff[bool] = False
    """At most two situations and three pushes, no experts beside, no film: a first look."""
    strict: FlagCreatePairsOff[bool] = False
    """Exit with 3 if a figure misses its limit."""

    def check(self) -> None:
        """Check the counts."""
        super().check()
        number("--teachers", self.teachers, 1, MANY)
        number("--situations", self.situations, 1, MANY)
        number("--pushes", self.pushes, 1, MANY)
        if self.workers is not None:
            number("--workers", self.workers, 1, MANY)

    def exit_code(self, answer: Answer) -> int:
        """1 where a trial is missing, 3 where a limit was missed and that was to be told."""
        if answer.get("lost"):
            return 1
        return 3 if self.strict and answer.get("missed") else 0

    def execute(self, study: "Study", line: str) -> Answer:
        """Run the study."""
        from tpsim.study import running
        from tpsim.study.plants import chosen, with_plants
        from tpsim.study.study import Plan
        from tpsim.study.teachers import run_teachers

        study = with_plants(study, chosen(self.plants)) if self.plants else study
        plan, workers = Plan(self.seed, self.situations, self.pushes), self.workers or cores()
        if self.quick or not self.experts:
            study = replace(study, contest=None)
        if self.quick:
            plan = replace(plan, situations=min(plan.situations, 2), pushes=min(plan.pushes, 3))
        if self.teachers > 1:
            return run_teachers(
                study, plan, self.teachers, self.folder, workers=workers, command=line
            )
        return running.run(
            study,
            plan,
            folder=self.folder,
            workers=workers,
            video=self.video and not self.quick,
            progress=sys.stderr.isatty(),
            command=line,
        )
