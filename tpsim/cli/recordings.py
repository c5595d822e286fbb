"""The commands about people's own recordings: look at a file, convert it, learn from it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from tpsim.cli.options import MANY, Answer, Command, number, writable
from tpsim.errors import ArgumentError


@dataclass(frozen=True, kw_only=True)
class Data(Command):
    """Look at a file of recordings, or convert it into another format."""

    action: Annotated[Positional[Literal["info", "convert"]], arg(metavar="info|convert")]
    """What to do."""
    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """A recording: npz, csv, mat, bag, mcap, hdf5, LeRobot folder, ..."""
    out: Annotated[Positional[Path | None], arg(metavar="[OUT]")] = None
    """File to write; its ending names the format."""
    format: str | None = None
    """Format of the file (default: by its name and content)."""

    def check(self) -> None:
        """Check that there is a file to write to where one is needed."""
        if (self.action == "convert") != (self.out is not None):
            raise ArgumentError("data convert FILE OUT names two files, data info FILE one")

    def execute(self) -> Answer:
        """Look, or convert."""
        from tpsim.data import commands

        if self.out is None:
            return commands.info(self.file, format=self.format)
        return commands.convert(self.file, self.out, format=self.format)


@dataclass(frozen=True, kw_only=True)
class LearnFile(Command):
    """Learn from a file of recordings: a model, what it retrieves, and a picture."""

    file: Annotated[Positional[Path], arg(metavar="FILE")]
    """A recording, as tpsim data info shows it."""
    frames: tuple[str, ...] = ()
    """Objects in the file to see the movement from (default: its own start and end)."""
    components: int | None = None
    """Number of Gaussians (default: by what errs least in situations left out)."""
    format: str | None = None
    """Format of the file (default: by its name and content)."""
    folder: Path = Path("learned")
    """Folder for the model, the picture and what was retrieved."""

    def check(self) -> None:
        """Check the number of Gaussians."""
        if self.components is not None:
            number("--components", self.components, 1, MANY)
        writable("--folder", self.folder)

    def execute(self) -> Answer:
        """Walk from the file to a model and a picture."""
        from tpsim.data import commands

        return commands.learn(
            self.file, self.frames, self.folder, format=self.format, components=self.components
        )
