"""What a session recorded: a trial, and what repeats it."""

from dataclasses import dataclass, replace

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


def until(trial: Trial, seconds: float) -> Trial:
    """The same trial as if it had ended after some time [s]."""
    keep = trial.time < seconds - 1e-9
    if keep.all():
        return trial
    arrays = {name: signal[keep] for name, signal in trial.arrays.items()}
    parted = trial.outcome == "contact" and not arrays["contact_steps"][-1:].any()
    return replace(trial, arrays=arrays, outcome="done" if parted else trial.outcome)
