"""The command that takes what was learned to a real robot."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tpsim.cli.options import Answer, Learning

if TYPE_CHECKING:
    from tpsim.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Export(Learning):
    """Write what was learned as a policy that drives a real robot without a simulator."""

    def execute(self, study: "Study", line: str) -> Answer:
        """Export."""
        from tpsim.deploy import export

        return export.export(study, self.source(), self.folder)
