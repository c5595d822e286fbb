"""What is measured of serving: sugar in the cup, nothing spilled, poured out, put back."""

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.study import health
from tpsim.study.held import held_measures
from tpsim.study.measure import Measure, mean
from tpsim.study.record import Record
from tpsim.tasks.serve import scene
from tpsim.world.trial import Trial

TILT, POUR, BACK = 8.0, (10.0, 10.0), (8.0, 4.0)
"""Tilt [deg] while the cup is carried, and distances [mm] and angles [deg] at the bowl and in the
dock, up to which serving has succeeded."""

OVER = 0.03
"""Distance [m] from its place over the bowl within which the cup may be tilted."""

HELD = 0.01
"""Distance [m] from its place in the hand up to which a thing is held."""

BOWL = (0.09, 0.06)
"""Radius and height [m] within which sugar is in the bowl."""


@dataclass(frozen=True)
class Served:
    """What came of one trial.

    Parameters
    ----------
    sugared : bool
        Sugar lay in the cup before this was poured out.
    in_bowl : bool
        Sugar is in the bowl at the end.
    left : bool
        The cup was taken, and stands by itself at the end.
    tilt : float
        Of the cup while it is carried, largest [deg].
    pour, back : (float, float)
        Distance [mm] and angle [deg] from the cup's place over the bowl when it is tilted most,
        and from that in the dock at the end.
    """

    sugared: bool
    in_bowl: bool
    left: bool
    tilt: float
    pour: tuple[float, float]
    back: tuple[float, float]

    @classmethod
    def of(cls, trial: Trial) -> "Served":
        """Look at a trial."""
        cup, bowl, dock = (trial.pose(name) for name in ("cup", "bowl", "dock"))
        held = _held(trial, "left_hand", "cup", scene.CUP.in_hand)
        tilt = np.degrees(np.arccos(np.clip(cup.rotation[:, 2, 2], -1, 1)))
        over = _seen(bowl, cup.position) - scene.POURED
        carried = held & (np.linalg.norm(over, axis=1) > OVER)
        most = int(np.argmax(tilt))
        sugar = _seen(cup, trial["sugar_position"])
        inside = (np.hypot(*sugar[:, :2].T) < scene.RADIUS) & (np.abs(sugar[:, 2]) < scene.RIM)
        x, y, z = _seen(bowl, trial["sugar_position"])[-1]
        return cls(
            sugared=bool((inside & (tilt < TILT) & (np.arange(len(tilt)) < most)).any()),
            in_bowl=bool(np.hypot(x, y) < BOWL[0] and 0 < z < BOWL[1]),
            left=bool(held.any() and not held[-1]),
            tilt=float(tilt[carried].max(initial=0.0)),
            pour=_apart(_at(bowl, most) @ scene.POUR, _at(cup, most)),
            back=_apart(_at(dock, -1) @ Pose(np.eye(3), np.array(scene.STANDS)), _at(cup, -1)),
        )

    @property
    def faults(self) -> tuple[str, ...]:
        """What went wrong, in words; nothing where it succeeded."""
        found = {
            "cup not put": not self.left,
            "sugar not in the cup": not self.sugared,
            "carried tilted": self.tilt > TILT,
            "poured beside": bool(np.any(np.array(self.pour) > POUR)),
            "sugar not in the bowl": not self.in_bowl,
            "put beside": bool(np.any(np.array(self.back) > BACK)),
        }
        return tuple(fault for fault, so in found.items() if so)

    @property
    def end(self) -> float:
        """How far from perfect pour and end are, in what is allowed of each, summed."""
        parts = (*np.divide(self.pour, POUR), *np.divide(self.back, BACK))
        return float(np.sum(parts))


def _at(poses: Pose, sample: int) -> Pose:
    return Pose(poses.rotation[sample], poses.position[sample])


def _seen(base: Pose, positions: np.ndarray) -> np.ndarray:
    """Positions (T, 3) in frames (T,)."""
    seen: np.ndarray = np.einsum("tji,tj->ti", base.rotation, positions - base.position)
    return seen


def _held(trial: Trial, hand: str, thing: str, in_hand: Pose) -> np.ndarray:
    """Whether a thing is in a hand (T,)."""
    R, p = trial.pose(hand)
    away = p + R @ in_hand.position - trial[f"{thing}_position"]
    # What stands where a hand is about to take it is not held yet: a hand that holds moves it.
    moved = np.linalg.norm(trial[f"{thing}_position"] - trial[f"{thing}_position"][0], axis=1)
    held: np.ndarray = (np.linalg.norm(away, axis=1) < HELD) & (moved > HELD)
    return held


def _apart(place: Pose, found: Pose) -> tuple[float, float]:
    """Distance [mm] and angle [deg] between two poses."""
    turned = np.linalg.norm(rotation.log(found.rotation @ place.rotation.T))
    away = np.linalg.norm(found.position - place.position)
    return float(1e3 * away), float(np.degrees(turned))


_SERVED: WeakKeyDictionary[Trial, Served] = WeakKeyDictionary()


def served(record: Record) -> Served:
    """What came of a recorded trial, looked at once."""
    trial = record.trial
    if trial not in _SERVED:
        _SERVED[trial] = Served.of(trial)
    return _SERVED[trial]


def success(record: Record) -> float:
    """100 where serving succeeded and nothing touched, else 0."""
    return 100.0 * (record.trial.outcome == "done" and not served(record).faults)


def faults(records: Sequence[Record]) -> dict[str, int]:
    """How often each thing went wrong in some trials."""
    counted: dict[str, int] = {}
    for record in records:
        outcome = () if record.trial.outcome == "done" else (record.trial.outcome,)
        for fault in (*outcome, *served(record).faults):
            counted[fault] = counted.get(fault, 0) + 1
    return counted


def end(record: Record) -> np.ndarray:
    """How far from perfect a trial's pour and end are (1,): :attr:`Served.end`."""
    return np.array([served(record).end])


def _distances(name: str, part: str, label: str, title: str) -> tuple[Measure, Measure]:
    allowed = {"pour": POUR, "back": BACK}[part]
    return (
        Measure(
            f"{name}_mm",
            of=lambda record: getattr(served(record), part)[0],
            unit="mm",
            label=label,
            limit=allowed[0],
            title=title,
        ),
        Measure(
            f"{name}_deg",
            of=lambda record: getattr(served(record), part)[1],
            unit="deg",
            label=label,
            limit=allowed[1],
            title="The same, orientation",
        ),
    )


def _after_holding() -> tuple[Measure, ...]:
    """What comes of being held, of the task's own controller and of the one by the clock."""
    found = []
    for name, suffix in (("learned", ""), ("by clock", "_by_clock")):
        limited = not suffix
        found += [
            Measure(
                f"success_held{suffix}_percent",
                of=success,
                unit="%",
                label="held",
                controller=name,
                across=mean,
                limit=90.0 if limited else None,
                at_least=True,
                title="The same, held for 5 s" + (", by clock" if suffix else ""),
            ),
            *held_measures(name, "Pour and end after being held, beside unheld, worst", end),
        ]
    return tuple(found)


MEASURES = (
    Measure(
        "success_percent",
        of=success,
        unit="%",
        label="unpushed",
        across=mean,
        limit=95.0,
        at_least=True,
        title="Sugar in the cup, nothing spilled, cup back",
    ),
    Measure(
        "success_pushed_percent",
        of=success,
        unit="%",
        label="pushed",
        across=mean,
        limit=90.0,
        at_least=True,
        title="The same, pushed in every phase",
    ),
    *_after_holding(),
    Measure(
        "tilt_carried_max_deg",
        of=lambda record: served(record).tilt,
        unit="deg",
        label="unpushed",
        limit=TILT,
        title="Tilt of the cup while carried, worst",
    ),
    *_distances("pour", "pour", "unpushed", "Cup from its place over the bowl, worst"),
    *_distances("back", "back", "unpushed", "Cup from its place in the dock, worst"),
    Measure(
        "tilt_carried_pushed_max_deg",
        of=lambda record: served(record).tilt,
        unit="deg",
        label="pushed",
        limit=TILT,
        title="Tilt of the cup while carried and pushed, worst",
    ),
    *_distances("pour_pushed", "pour", "pushed", "Cup from its place over the bowl, pushed, worst"),
    *_distances("back_pushed", "back", "pushed", "Cup from its place in the dock, pushed, worst"),
    health.SATURATED,
    health.DIVERGED,
    health.CONTACTS,
    health.INJECTED,
    health.realtime(8.0),
)
