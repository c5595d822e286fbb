"""The command play: teach, push and watch in the browser."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tpsim.cli.options import SEEDS, Answer, Learning, number

if TYPE_CHECKING:
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Play(Learning):
    """Teach, push and watch in the browser."""

    host: str = "127.0.0.1"
    """Address to serve; another than this machine's own gets a token, and a warning."""
    port: int = 8080
    """Port to serve; 0 takes one that is free."""
    seed: int = 0
    """Seed of the situations."""

    def check(self) -> None:
        """Check the port."""
        super().check()
        number("--port", self.port, 0, 65535)
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
