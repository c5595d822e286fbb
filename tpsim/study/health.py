"""What can go wrong in trials, counted: measures that every study shares."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import cast

import numpy as np

from tpsim.study.measure import Measure
from tpsim.study.record import Record, Records

Labels = str | Sequence[str] | None
"""Conditions whose trials count; all by default."""


def saturated_steps(
    records: Records, controller: str | None = "learned", label: Labels = None
) -> int:
    """Time steps with a motor at its limit, in all trials of a controller; None for all."""
    return int(sum(record["saturated_steps"][-1] for record in records.select(label, controller)))


def diverged(records: Records, controller: str | None = "learned", label: Labels = None) -> int:
    """Trials in which the robot became faster than any robot."""
    return sum(record.trial.outcome == "diverged" for record in records.select(label, controller))


def contacts(records: Records, controller: str | None = "learned", label: Labels = None) -> int:
    """Trials in which something touched."""
    return sum(record.trial.outcome == "contact" for record in records.select(label, controller))


def saturated_percent(records: Records) -> float:
    """Share of time steps with a motor at its limit [%]."""
    steps = sum(round(record.trial.time[-1] * 1000) for record in records.select())
    return 100 * saturated_steps(records) / max(steps, 1)


def unreachable_samples(
    records: Records, controller: str | None = "learned", label: Labels = None
) -> int:
    """Samples in which a joint was asked to go to where its limit is guarded, or beyond."""
    return int(
        sum(record["beyond_limits"].any(1).sum() for record in records.select(label, controller))
    )


def injected(record: Record) -> np.ndarray | None:
    """Energy (T,) [J] that impedances have put in beyond what their dampers took.

    It is what came out of the tank; None where joint torques were commanded.
    """
    arrays = record.trial.arrays
    if "energy_injected" not in arrays:
        return None
    net: np.ndarray = arrays["energy_injected"] - arrays["energy_dissipated"]
    return net


INJECTED = Measure(
    "energy_injected_max_J",
    of=injected,
    unit="J",
    title="Energy injected beyond what dampers took, largest",
)
SATURATED = Measure(
    "saturated_steps", whole=saturated_steps, title="Time steps with a saturated motor"
)
DIVERGED = Measure("diverged", whole=diverged, limit=0, title="Diverged trials")
CONTACTS = Measure("contacts", whole=contacts, limit=0, title="Trials in which something touched")
UNREACHABLE = Measure(
    "unreachable_samples",
    whole=unreachable_samples,
    title="Samples that asked for a posture at or beyond joint limits",
)


def of_all(measure: Measure, label: Labels = None) -> Measure:
    """One of these measures, counted in the trials of all controllers under some labels."""
    count = cast(Callable[..., int], measure.whole)
    return replace(measure, whole=partial(count, controller=None, label=label))


def realtime(least: float) -> Measure:
    """Simulated over processor time of a trial; runs measure it beside the trials."""
    return Measure(
        "realtime_factor",
        unit="x",
        limit=least,
        at_least=True,
        title="Faster than real time, one core",
    )
