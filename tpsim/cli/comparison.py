"""The command that compares the methods of Section 8."""

import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import UseAppendAction, arg

from tpsim.cli.options import MANY, SEEDS, Answer, Command, number, writable
from tpsim.errors import ArgumentError
from tpsim.versions import cores


@dataclass(frozen=True, kw_only=True)
class Compare(Command):
    """Measure the methods of the tutorial's Section 8, and yours, side by side."""

    quick: bool = False
    """One task, four demonstrations, two teachers: a minute instead of many."""
    method: Annotated[tuple[str, ...], arg(metavar="FILE.PY:FUNCTION"), UseAppendAction] = ()
    """A method of your own beside the others, from demonstrations to a function of frames; give the
    option again for each further one."""
    data: Path | None = None
    """Demonstrations of your own: each is left out once and predicted by the others."""
    frames: tuple[str, ...] = ()
    """Objects in the files of --data that movements are seen from, as in `tpsim learn`."""
    closed_loop: bool = False
    """Carry the movements out on simulated arms, too: a planar one and Baxter's, pushed."""
    seed: int = 0
    """Seed of the first teacher."""
    workers: int | None = None
    """Number of processes (default: one per core)."""
    folder: Path | None = None
    """Folder to write to, and to go on from (default: one in recordings/runs)."""

    def check(self) -> None:
        """Check the numbers, the folder and the file of demonstrations."""
        number("--seed", self.seed, 0, SEEDS)
        if self.workers is not None:
            number("--workers", self.workers, 1, MANY)
        writable("--folder", self.folder)
        if self.data is not None and not self.data.exists():
            raise ArgumentError(f"--data {self.data} does not exist; give a file or a folder")
        if self.frames and self.data is None:
            raise ArgumentError(
                f"--frames {' '.join(self.frames)} are objects in the files of --data; give both"
            )
        if self.data is not None and self.closed_loop:
            raise ArgumentError(
                "--closed-loop needs a teacher's movement in new situations, which --data has not; "
                "give one of both"
            )

    def execute(self) -> Answer:
        """Measure all methods, or go on where it stopped."""
        from tpsim import paths
        from tpsim.section8 import compare, compare_left_out
        from tpsim.section8.methods import with_methods_from
        from tpsim.section8.plan import QUICK, Plan
        from tpsim.section8.tables import short

        methods = with_methods_from(self.method)
        kind = "data" if self.data else "quick" if self.quick else "full"
        folder = self.folder or paths.runs() / f"compare-{kind}-seed-{self.seed}"
        if self.data is not None:
            from tpsim import data

            columns = [data.Columns(frames=self.frames)] if self.frames else []
            taught = list(data.read(self.data, *columns))
            result = compare_left_out(taught, methods, folder=folder, command=self._line())
        else:
            arms = {}
            if self.closed_loop:
                from tpsim.section8 import closed_loop

                arms = closed_loop.QUICK if self.quick else closed_loop.PLANS
            result = compare(
                methods,
                QUICK if self.quick else Plan(),
                seed=self.seed,
                folder=folder,
                workers=self.workers or cores(),
                progress=sys.stderr.isatty(),
                command=self._line(),
                arms=arms,
            )
        return result if self.json else short(result)

    def _line(self) -> str:
        """Return the command line that repeats the comparison."""
        words = ["tpsim", "compare", *(["--quick"] if self.quick else [])]
        words += ["--closed-loop"] if self.closed_loop else []
        words += [word for method in self.method for word in ("--method", method)]
        words += ["--data", str(self.data)] if self.data else []
        words += ["--frames", *self.frames] if self.frames else []
        words += ["--seed", str(self.seed)] if self.seed else []
        return shlex.join(words)
