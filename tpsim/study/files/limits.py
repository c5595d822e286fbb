"""What recordings may ask for: bounds on times, rates and sizes, checked before anything runs."""

from typing import TYPE_CHECKING

from tpsim.errors import RecordingError

if TYPE_CHECKING:  # where policies run there is no simulator
    from tpsim.study.condition import Condition

TIMESTEP = 1e-5, 0.1
"""Time step of a recorded scene [s], least and most."""

STEPS = 2_000_000
"""Time steps of a recorded trial, and of all that happens in it."""

TEXT = 64 * 2**20
"""Bytes of ``run.json``, of ``scene.xml`` and of ``policy.json``."""

ASSETS = 2**30
"""Bytes of all meshes and textures."""


def check_condition(condition: "Condition", timestep: float, where: object) -> None:
    """Refuse a condition that would run for ever or fill the memory.

    Parameters
    ----------
    condition : Condition
    timestep : float
        Of the scene [s].
    where : object
        Name of the file, for messages.

    Raises
    ------
    RecordingError
        Names file and field.
    """
    for name, seconds in _times(condition).items():
        if not 0 <= seconds <= STEPS * timestep:
            raise RecordingError(
                f"{where}: {name} is {seconds} s; from 0 to {STEPS * timestep:g} s"
            )
    situation = condition.situation
    for name, number in (
        ("situation.seed", situation.seed),
        ("situation.index", situation.index),
        ("plant.seed", condition.plant.seed),
    ):
        if not 0 <= number < 2**63:
            raise RecordingError(f"{where}: {name} is {number}; from 0 to below 2^63")


def _times(condition: "Condition") -> dict[str, float]:
    times = {"duration": condition.duration or 0.0, "plant.latency": condition.plant.latency}
    for i, lead in enumerate(condition.lead):
        for name in ("start", "duration", "rest"):
            times[f"lead[{i}].{name}"] = getattr(lead, name)
    for i, hold in enumerate(condition.hold):
        for name in ("start", "duration"):
            times[f"hold[{i}].{name}"] = getattr(hold, name)
    for i, drag in enumerate(condition.drag):
        times[f"drag[{i}].times"] = drag.times[-1]
    for i, path in enumerate(condition.situation.objects):
        times[f"situation.objects[{i}].times"] = max(0.0, path.times[-1])
    return times
