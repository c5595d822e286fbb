"""What is measured of cup and sugar."""

from collections.abc import Sequence

import numpy as np

from tpsim.study import health
from tpsim.study.measure import Measure, rms
from tpsim.study.metrics import displacement, mean_force
from tpsim.study.record import Record, Records
from tpsim.task.task import Models, Task
from tpsim.tasks.cup_and_sugar import cup, sugar

PUSHED_SINCE = 2.0
"""When pushes begin [s]: what comes before is the way from the start."""


def taught_place(models: Models) -> np.ndarray:
    """Where the sugar was taught to be, in the cup's frame (3,) [m]."""
    model = models["sugar"]
    frame = model.frames[list(sugar.VIEWS).index("sugar from cup")]
    place: np.ndarray = model.priors @ frame.mean[:, :3]
    return place


def offset(record: Record) -> np.ndarray:
    """Distance (T,) [mm] of the sugar from its taught place above the cup."""
    view = sugar.ABOVE.position.minus(taught_place(record.models))
    return 1e3 * np.linalg.norm(record.see(view), axis=1)


def yielding(point: str):  # type: ignore[no-untyped-def]
    """Distance (T,) [mm] of a recorded site from where it is when nobody pushes."""

    def moved(record: Record) -> np.ndarray | None:
        position = record[f"{point}_position"]
        if record.condition.controller != "learned":
            # A fixed gain starts where it stays.
            return 1e3 * np.linalg.norm(position - position[0], axis=1)
        twin = record.beside("unpushed")
        if twin is None:
            return None
        return 1e3 * displacement(record.trial, twin.trial, f"{point}_position")

    return moved


def lead_force(record: Record) -> float:
    """Mean force [N] that a leading person feels."""
    return mean_force(record["lead_wrench"])


def force_ratio(records: Records) -> float | None:
    """Displacement under the learned controller over that under stiff gains."""
    means = {}
    for name in ("learned", "stiff"):
        found = Measure("", of=yielding("left_hand"), label="pushed", controller=name, across=_mean)
        means[name] = found.figure(records)
    if means["learned"] is None or means["stiff"] is None:
        return None
    return float(means["learned"] / means["stiff"])


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values))


def _rms(values: Sequence[float]) -> float:
    return rms(np.array(values))


def _pushed(name: str, **fields: object) -> Measure:
    return Measure(name, label="pushed", otherwise="unpushed", **fields)  # type: ignore[arg-type]


_TILT = (
    _pushed("tilt_max_deg", of=cup.LEVEL, unit="deg", limit=5.0, title="Cup tilt, largest"),
    _pushed(
        "tilt_rms_deg",
        of=cup.LEVEL,
        unit="deg",
        reduce=rms,
        across=_rms,
        limit=2.5,
        title="Cup tilt, rms",
    ),
)
_OFFSET = (
    _pushed(
        "offset_max_mm",
        of=offset,
        unit="mm",
        limit=15.0,
        title="Sugar from its taught place, largest",
    ),
    _pushed(
        "offset_rms_mm",
        of=offset,
        unit="mm",
        reduce=rms,
        across=_rms,
        limit=8.0,
        title="Sugar from its taught place, rms",
    ),
)


def _displacement(controller: str, title: str, limit: float | None = None) -> Measure:
    prefix = "" if controller == "learned" else f"{controller}_"
    return Measure(
        f"{prefix}displacement_mean_mm",
        of=yielding("left_hand"),
        unit="mm",
        label="pushed",
        controller=controller,
        across=_mean,
        limit=limit,
        at_least=True,
        title=title,
    )


_YIELDING = (
    _displacement("learned", "Pushed hand yields, mean of peaks", 40.0),
    _displacement("stiff", "The same under stiff fixed gains"),
    _displacement("soft", "The same under soft fixed gains"),
)
_FIXED_OFFSETS = tuple(
    Measure(
        f"{name}_offset_max_mm",
        of=offset,
        unit="mm",
        label="pushed",
        controller=name,
        title=f"Sugar offset under {name} fixed gains, largest",
    )
    for name in ("stiff", "soft")
)
_RATIO = Measure(
    "force_ratio",
    whole=force_ratio,
    unit="x",
    limit=3.0,
    at_least=True,
    title="Displacement under the same force, learned over stiff",
)
_ELBOW_AND_LEAD = (
    Measure(
        "elbow_displacement_min_mm",
        of=yielding("right_elbow"),
        unit="mm",
        label="elbow",
        across=min,
        limit=20.0,
        at_least=True,
        title="Pushed elbow moves, least",
    ),
    Measure(
        "elbow_offset_max_mm",
        of=offset,
        unit="mm",
        label="elbow",
        window=(PUSHED_SINCE, np.inf),
        limit=5.0,
        title="Sugar offset while the elbow is pushed",
    ),
    Measure(
        "lead_offset_max_mm",
        of=offset,
        unit="mm",
        label="led",
        limit=20.0,
        title="Sugar offset while the left hand is led 15 cm",
    ),
    Measure(
        "lead_force_mean_N",
        of=lead_force,
        unit="N",
        label="led",
        across=_mean,
        limit=15.0,
        title="Force that the leading person feels, mean",
    ),
)
_HEALTH = (
    Measure(
        "stiffness_error_percent",
        unit="%",
        limit=3.0,
        title="Stiffness felt against commanded, error",
    ),
    health.SATURATED,
    Measure(
        "saturated_percent",
        whole=health.saturated_percent,
        unit="%",
        limit=1.0,
        title="Time steps with a saturated motor",
    ),
    health.DIVERGED,
    health.CONTACTS,
    health.realtime(8.0),
)


def measures(task: Task) -> tuple[Measure, ...]:
    """Measures of one or both behaviours."""
    taught = task.behaviours()
    found: tuple[Measure, ...] = _TILT if "cup" in taught else ()
    found += (_OFFSET if "sugar" in taught else ()) + _YIELDING
    if "sugar" in taught:
        found += (*_FIXED_OFFSETS, *_ELBOW_AND_LEAD)
    return (*found, _RATIO, *_HEALTH)
