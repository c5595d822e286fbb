"""The command play: teach, push and watch in the browser."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from tyro.conf import Positional, arg

from tpsim.cli.options import SEEDS, Answer, Command, Learning, Options, number

if TYPE_CHECKING:
    from tpsim.study.study import Study

PLANE = "plane"
"""The word for the planar example."""


@dataclass(frozen=True, kw_only=True)
class Served(Options):
    """What every page has."""

    host: str = "127.0.0.1"
    """Address to serve; another than this machine's own gets a token, and a warning."""
    port: int = 8080
    """Port to serve; 0 takes one that is free."""

    def check(self) -> None:
        """Check the port."""
        super().check()
        number("--port", self.port, 0, 65535)


@dataclass(frozen=True, kw_only=True)
class Play(Served, Learning):
    """Teach, push and watch a TASK in the browser; or a RUN_FOLDER, or plane, the 2-D example."""

    seed: int = 0
    """Seed of the situations."""

    def check(self) -> None:
        """Check the seed."""
        super().check()
        number("--seed", self.seed, 0, SEEDS)

    def execute(self, study: "Study", line: str) -> Answer:
        """Open the playground until Ctrl-C."""
        from tpsim.play.playground import play
        from tpsim.play.server import Address

        return play(
            study,
            Address.of(self.host, self.port),
            source=self.source(),
            folder=self.folder,
            seed=self.seed,
            command=line,
        )


@dataclass(frozen=True, kw_only=True)
class Watch(Served, Command):
    """Watch a recorded run in the browser, or play with the planar example."""

    what: Annotated[Positional[str], arg(metavar="RUN_FOLDER")]
    """A run's folder, or plane."""

    def execute(self) -> Answer:
        """Open the page until Ctrl-C."""
        from tpsim.play.playground import watch, watch_plane
        from tpsim.play.server import Address

        address = Address.of(self.host, self.port)
        if self.what == PLANE:
            return watch_plane(address)
        return watch(Path(self.what), address)


def is_watched(words: list[str]) -> bool:
    """Whether what is named is no task, but a run's folder or the planar example."""
    named = [word for word in words if not word.startswith("-")]
    return bool(named) and (named[0] == PLANE or (Path(named[0]) / "run.json").is_file())
