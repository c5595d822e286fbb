"""What is measured of cup and sugar; what counts while pushed is what is looked at then."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from tpsim import rotation
from tpsim.robot.views.view import View
from tpsim.study import health
from tpsim.study.measure import Measure, mean, most, rms
from tpsim.study.metrics import displacement, mean_force, push_interval
from tpsim.study.record import Record, Records
from tpsim.task.task import Models, Task
from tpsim.tasks.cup_and_sugar import cup, sugar
from tpsim.tasks.workplace import size_of

COMPARED: Mapping[str, str] = {"stiff": "stiff fixed gains", "soft": "soft fixed gains"}
"""Controllers beside the learned one, and what reports call them."""

RELEASED = 0.3
"""Time [s] after a push from which on the hand counts as let go."""

MIDDLE = 1.65
"""Time [s] at which situations are compared: the middle of the times at which pushes begin."""


def taught_place(models: Models) -> np.ndarray:
    """Where the sugar was taught to be, in the cup's frame (3,) [m]."""
    model = models["sugar"]
    frame = model.frames[list(sugar.VIEWS).index("sugar from cup")]
    place: np.ndarray = model.priors @ frame.mean[:, :3]
    return place


def tilt(record: Record) -> np.ndarray:
    """Angle (T,) [deg] of the cup's axis from the vertical."""
    return np.degrees(np.linalg.norm(record.see(cup.LEVEL), axis=1))


def offset(record: Record) -> np.ndarray:
    """Distance (T,) [mm] of the sugar from its taught place above the cup."""
    view = sugar.ABOVE.position.minus(taught_place(record.models))
    return 1e3 * np.linalg.norm(record.see(view), axis=1)


def yielding(point: str) -> Callable[[Record], np.ndarray | None]:
    """Distance (T,) [mm] of a recorded site from where it is when nobody pushes."""

    def moved(record: Record) -> np.ndarray | None:
        position = record[f"{point}_position"]
        if record.condition.controller != "learned":
            # The others begin where they stay.
            return 1e3 * np.linalg.norm(position - position[0], axis=1)
        twin = record.beside("unpushed")
        if twin is None:
            return None
        return 1e3 * displacement(record.trial, twin.trial, f"{point}_position")

    return moved


def stays(record: Record) -> float | None:
    """How far [mm] the pushed hand moves by itself after it was let go."""
    window = push_interval(record.trial)
    if window is None:
        return None
    after = record["left_hand_position"][record.trial.time >= window[1] + RELEASED]
    return float(1e3 * np.linalg.norm(after - after[0], axis=1).max()) if len(after) else None


def lead_force(record: Record) -> float:
    """Mean force [N] that a leading person feels."""
    return mean_force(record["lead_wrench"])


def force_ratio(records: Records) -> float | None:
    """Mean force that leads the hand the same way, under stiff gains over the learned."""
    stiff, learned = (
        [lead_force(record) for record in records.select("led", name)]
        for name in ("stiff", "learned")
    )
    return mean(stiff) / mean(learned) if stiff and learned else None


def hand_spread(records: Records) -> float | None:
    """Mean distance [mm] between the left hands of two situations, when pushes begin."""
    return _spread(records, lambda record, k: 1e3 * record["left_hand_position"][k])


def yaw_spread(records: Records) -> float | None:
    """Mean difference [deg] between the headings of the cup in two situations, likewise."""

    def yaw(record: Record, k: int) -> np.ndarray:
        R = rotation.from_quaternion(record["cup_quaternion"][k])
        return np.degrees(np.arctan2(R[1, 0], R[0, 0]))

    return _spread(records, yaw)


def _spread(records: Records, of: Callable[[Record, int], np.ndarray]) -> float | None:
    found = []
    for record in records.select("unpushed"):
        time = record.trial.time
        k = min(int(np.searchsorted(time, MIDDLE)), len(time) - 1)
        found.append(np.atleast_1d(of(record, k)))
    pairs = [float(np.linalg.norm(a - b)) for i, a in enumerate(found) for b in found[:i]]
    return mean(pairs) if pairs else None


def _errors(
    name: str, unit: str, of: View | Callable[[Record], np.ndarray], title: str, limit: float
) -> tuple[Measure, ...]:
    """Error while somebody pushes: that of 95 % of the trials, the largest, and rms."""

    def measure(
        which: str,
        said: str,
        *,
        reduce: Callable[[np.ndarray], float] = np.max,
        across: Callable[[Sequence[float]], float] = max,
        limit: float | None = None,
    ) -> Measure:
        return Measure(
            f"{name}_{which}_{unit}",
            of=of,
            unit=unit,
            label="pushed",
            otherwise="unpushed",
            window="pushed",
            reduce=reduce,
            across=across,
            limit=limit,
            title=f"{title} while pushed, {said}",
        )

    return (
        measure("p95", "largest in 95 % of the trials", across=most, limit=limit),
        measure("max", "largest of all", limit=2 * limit),
        measure("rms", "rms", reduce=rms, across=lambda values: rms(np.array(values))),
    )


_TILT = _errors("tilt", "deg", cup.LEVEL, "Cup tilt", 3.0)
_OFFSET = _errors("offset", "mm", offset, "Sugar from its taught place", 6.0)


def _displacement(controller: str, title: str, limit: float | None = None) -> Measure:
    prefix = "" if controller == "learned" else f"{controller}_"
    return Measure(
        f"{prefix}displacement_mean_mm",
        of=yielding("left_hand"),
        unit="mm",
        label="pushed",
        controller=controller,
        across=mean,
        limit=limit,
        at_least=True,
        title=title,
    )


def _beside(name: str, said: str) -> tuple[Measure, ...]:
    """The same errors under another controller, in the same pushes."""
    common = {"label": "pushed", "controller": name, "window": "pushed", "across": most}
    return (
        Measure(
            f"{name}_tilt_p95_deg",
            of=cup.LEVEL,
            unit="deg",
            title=f"Cup tilt under {said}, largest in 95 % of the trials",
            **common,  # type: ignore[arg-type]
        ),
        Measure(
            f"{name}_offset_p95_mm",
            of=offset,
            unit="mm",
            title=f"Sugar offset under {said}, largest in 95 % of the trials",
            **common,  # type: ignore[arg-type]
        ),
    )


def _elbow_and_lead(size: float) -> tuple[Measure, ...]:
    return (
        Measure(
            "elbow_displacement_min_mm",
            of=yielding("right_elbow"),
            unit="mm",
            label="elbow",
            across=min,
            limit=20.0 * size,
            at_least=True,
            title="Pushed elbow moves, least",
        ),
        Measure(
            "elbow_offset_max_mm",
            of=offset,
            unit="mm",
            label="elbow",
            window="pushed",
            limit=5.0,
            title="Sugar offset while the elbow is pushed",
        ),
        Measure(
            "lead_offset_max_mm",
            of=offset,
            unit="mm",
            label="led",
            limit=6.0,
            title="Sugar offset while the left hand is led",
        ),
        Measure(
            "lead_force_mean_N",
            of=lead_force,
            unit="N",
            label="led",
            across=mean,
            limit=8.0 * size,
            title="Force that the leading person feels, mean",
        ),
        Measure(
            "force_ratio",
            whole=force_ratio,
            unit="x",
            limit=3.0,
            at_least=True,
            title="Force that leads the hand the same way, stiff gains over learned",
        ),
    )


def _stays(size: float) -> Measure:
    return Measure(
        "stays_max_mm",
        of=stays,
        unit="mm",
        label="pushed",
        limit=20.0 * size,
        title="Hand that is let go moves by itself, at most",
    )


def _spreads(size: float) -> tuple[Measure, ...]:
    return (
        Measure(
            "hand_spread_mm",
            whole=hand_spread,
            unit="mm",
            limit=80.0 * size,
            at_least=True,
            title="Hands of two situations are apart when pushed, mean",
        ),
        Measure(
            "yaw_spread_deg",
            whole=yaw_spread,
            unit="deg",
            limit=20.0,
            at_least=True,
            title="Cups of two situations are turned apart when pushed, mean",
        ),
    )


_HEALTH = (
    Measure(
        "stiffness_error_percent",
        unit="%",
        limit=1.0,
        title="Stiffness measured against commanded, error",
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
    health.INJECTED,
    health.realtime(8.0),
)


def measures(task: Task) -> tuple[Measure, ...]:
    """Measures of one or both behaviours; limits of distances and forces go with the size."""
    taught, size = task.behaviours(), size_of(task.stage.robot)
    found: tuple[Measure, ...] = _TILT if "cup" in taught else ()
    found += (
        *(_OFFSET if "sugar" in taught else ()),
        _displacement("learned", "Pushed hand yields, mean of peaks", 130.0 * size),
        _stays(size),
        *(_displacement(n, f"Yields under {said}") for n, said in COMPARED.items()),
    )
    if "sugar" in taught:
        found += tuple(m for n, said in COMPARED.items() for m in _beside(n, said))
        found += _elbow_and_lead(size)
    return (*found, *_spreads(size), *_HEALTH)
