"""What a session recorded: a trial, and what repeats it."""

from dataclasses import dataclass

from tpsim.study.condition import Condition
from tpsim.world.trial import Trial


@dataclass(frozen=True)
class Recorded:
    """What was recorded, with what repeats it.

    Parameters
    ----------
    trial : Trial
    condition : Condition
        Of a performance; of a demonstration its start, objects, hands and duration.
    behaviour : str
        That was shown; empty for a performance.
    fault : str
        Why it had better not be learned from; empty where nothing speaks against it.
    """

    trial: Trial
    condition: Condition
    behaviour: str = ""
    fault: str = ""
