"""What a person sees while leading: late, now and then, and acted upon where it matters."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pinocchio as pin

from tpsim.border import Moment, Range, checked
from tpsim.pose import Pose

GIVES_UP = (0.05, 0.5)
"""Distance [m] and angle [rad] by which a person leads beyond what is wanted, at most."""


@dataclass(frozen=True)
class Sight:
    """How a person sees what it leads and what it watches, and corrects it.

    What is seen is ``delay`` old. A watched object is expected where its velocity takes it
    meanwhile; its acceleration comes as a surprise. Errors of what is led are corrected one look
    after another, by a share of what was seen, and only in the directions that matter.

    Parameters
    ----------
    delay : float
        Of all that is seen [s].
    interval : float
        Time between two looks at what is led [s].
    first : float
        When the first look is [s]: two hands may be looked at in turn.
    gain : float
        Share of the error that one look corrects. Below 0.6 the loop is stable although looks
        at ``interval`` see the correction before the last: c[k+1] = c[k] - gain c[k-2].
    smoothing : float
        Time constant with which a correction is carried out [s].

    Raises
    ------
    ArgumentError
        Times or a gain out of their range.
    """

    delay: Moment = 0.2
    interval: Annotated[float, Range(least=0.05, most=1e6)] = 0.3
    first: Moment = 0.0
    gain: Annotated[float, Range(least=0, below=0.6)] = 0.15
    smoothing: Moment = 0.1

    def __post_init__(self) -> None:
        checked(self)


Moving = tuple[Pose, np.ndarray]
"""A pose and its twist (6,): linear over angular velocity, world-aligned."""


class Watched:
    """One object as a person sees it."""

    def __init__(self, delay: float, timestep: float):
        self._timestep, self._past = timestep, deque[Moving](maxlen=round(delay / timestep) + 1)

    def expect(self, pose: Pose, twist: np.ndarray) -> Moving:
        """Where a person takes the object to be that is at a pose now."""
        self._past.append((pose, twist))
        (R, p), moved = self._past[0]
        age = self._timestep * (len(self._past) - 1)
        turned = pin.exp3(age * moved[3:])
        return Pose(turned.dot(R), p + age * moved[:3]), moved


class Correction:
    """How far a person leads beyond what is wanted, by errors seen so far.

    Parameters
    ----------
    sight : Sight
    timestep : float
        [s]
    """

    def __init__(self, sight: Sight, timestep: float):
        self._late, self._first = round(sight.delay / timestep), round(sight.first / timestep)
        self._interval = round(sight.interval / timestep)
        self._share = 1 - np.exp(-timestep / sight.smoothing) if sight.smoothing else 1.0
        self._gain = sight.gain
        self._noted: dict[int, np.ndarray] = {}
        self._decided, self.now = np.zeros(6), np.zeros(6)

    def act(
        self,
        step: int,
        error: Callable[[], np.ndarray],
        care: Callable[[], np.ndarray],
        able: Callable[[], bool],
    ) -> None:
        """Take note of an error; look, where it is time to, and correct.

        What is not seen in any look is not asked for.

        Parameters
        ----------
        step : int
            Since the hand took hold: 0, 1, 2, ...
        error : callable
            What is missing (6,) [m], [rad].
        care : callable
            How much each of it matters (6,), 0 to 1.
        able : callable
            Whether the person's strength is not exhausted: nobody pulls harder than that.
        """
        if step == 0 or self._looks(step + self._late):
            self._noted[step] = error()
        if self._looks(step) and able():
            seen = self._noted[max(step - self._late, 0)]
            self._decided = self._decided + self._gain * care() * seen
            for part, most in zip((self._decided[:3], self._decided[3:]), GIVES_UP, strict=True):
                part *= min(1.0, most / max(float(np.linalg.norm(part)), 1e-12))
        self.now = self.now + self._share * (self._decided - self.now)

    def _looks(self, step: int) -> bool:
        return step >= self._first and (step - self._first) % self._interval == 0


def foreseen(places: np.ndarray, timestep: float, delay: float) -> np.ndarray:
    """Where a person expects what moves along places (T, d): by position and velocity, both late.

    At rest before the first place.
    """
    steps = round(delay / timestep)
    if not steps:
        return places
    late = np.concatenate([np.repeat(places[:1], steps, 0), places[:-steps]])
    speed = np.gradient(late, timestep, axis=0)
    expected: np.ndarray = late + delay * speed
    return expected
