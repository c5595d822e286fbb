"""How a robot sees the objects around it: now and then, late, with noise, and not behind others."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from tpsim import rotation
from tpsim.border import Moment, NotNegative, Positive, Range, SeedNumber, border, checked
from tpsim.control.pose_filter import PoseFilter, smoothed
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.world.trial import Trial

Rate = Annotated[float, Range(least=0.1, most=1000)]
Occlusion = tuple[str, float, float]
"""An object, and from when until when it is hidden [s]; times before zero are before the start."""


@dataclass(frozen=True)
class Perception:
    """A camera that sees objects, and what is made of its pictures (:class:`PoseFilter`).

    Parameters
    ----------
    rate : float
        Pictures per second [Hz].
    latency : float
        Time from a picture until what is on it is known [s].
    position_noise : float
        How far a sighting is off, root mean square [m].
    angle_noise : float
        By which angle it is turned, root mean square [rad].
    wander : (float, float)
        Standard deviation of what objects are believed to move and turn in one second if nobody
        looks [m/s^0.5], [rad/s^0.5].
    occluded : tuple of (str, float, float)
        Objects, and from when until when each is hidden [s].
    before : float
        How long the camera has looked when a trial begins [s].
    seed : int
        Of the noise.
    """

    rate: Rate = 20.0
    latency: Moment = 0.05
    position_noise: Positive = 0.005
    angle_noise: Positive = float(np.radians(2.0))
    wander: tuple[NotNegative, NotNegative] = (0.005, 0.02)
    occluded: tuple[Occlusion, ...] = ()
    before: Annotated[float, Range(least=0, most=60)] = 1.0
    seed: SeedNumber = 0

    def __post_init__(self) -> None:
        checked(self)
        for name, since, until in self.occluded:
            if until <= since:
                raise ArgumentError(
                    f"perception occluded: '{name}' is hidden from {since:g} s until {until:g} s; "
                    "give a time that is later"
                )

    @property
    def deviations(self) -> tuple[float, float]:
        """Standard deviation of a sighting along each axis [m], and about it [rad]."""
        return self.position_noise / np.sqrt(3), self.angle_noise / np.sqrt(3)

    @border
    def remembered(self, trial: Trial) -> Trial:
        """A trial as it is remembered from pictures: objects where all of these say they were.

        What was hidden for a while is known from before and after. For demonstrations that are to
        be learned from.

        Raises
        ------
        ArgumentError
            If an object was hidden all the time; the message names it.
        """
        poses = {name: trial.pose(name) for name in trial.channels.objects}
        first, last, rng = float(trial.time[0]), float(trial.time[-1]), self._noise()
        seen: dict[str, list[tuple[float, Pose]]] = {name: [] for name in poses}
        for k in range(-round(self.before * self.rate), int(self.rate * (last - first)) + 1):
            time = first + k / self.rate
            row = int(np.searchsorted(trial.time, time - 1e-9))
            now = {name: pose.at(row) for name, pose in poses.items()}
            for name, pose in self._picture(now, k / self.rate, rng).items():
                seen[name].append((time, pose))
        arrays = dict(trial.arrays)
        for name, sightings in seen.items():
            if not sightings:
                raise ArgumentError(f"object '{name}' was never seen in the trial; hide it less")
            found = smoothed(sightings, trial.time, self.deviations, self.wander)
            arrays[f"{name}_position"] = np.array([one.pose.position for one in found])
            turned = np.array([one.pose.quaternion for one in found])
            arrays[f"{name}_quaternion"] = rotation.continuous(turned)
        return replace(trial, arrays=arrays)

    def _picture(
        self, objects: Mapping[str, Pose], time: float, rng: np.random.Generator
    ) -> dict[str, Pose]:
        """What one picture shows of objects that are at these poses: all that is not hidden."""
        far, wide = self.deviations
        found = {}
        for name, (R, p) in objects.items():
            # Drawn in any case: what is hidden changes nothing of how the rest is seen.
            moved, turned = rng.standard_normal((2, 3))
            if not self.hides(name, time):
                found[name] = Pose(rotation.exp(wide * turned) @ R, p + far * moved)
        return found

    def _noise(self) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(7,)))

    @border
    def hides(self, name: str, time: float) -> bool:
        """Whether an object is hidden at a time [s]."""
        return any(name == one and since <= time < until for one, since, until in self.occluded)


class Camera:
    """What a perception makes of the objects in one trial, picture by picture.

    Parameters
    ----------
    perception : Perception
    rows : mapping of str to int
        Row of each object.
    first : Objects
        Where objects are before the trial begins.

    Raises
    ------
    ArgumentError
        If something is to be hidden that is no object of the scene.
    """

    def __init__(self, perception: Perception, rows: Mapping[str, int], first: Objects):
        if unknown := [name for name, *_ in perception.occluded if name not in rows]:
            raise ArgumentError(
                f"perception occluded: there is no object '{unknown[0]}' in the scene; it has "
                f"{', '.join(sorted(rows)) or 'none'}"
            )
        self._perception, self._rows = perception, dict(rows)
        self._rng = perception._noise()
        self._filters = {
            name: PoseFilter(perception.deviations, perception.wander) for name in rows
        }
        self._coming: deque[tuple[float, str, Pose]] = deque()
        self._next = -round(perception.before * perception.rate)
        self._known = self._estimate(0.0, first)
        self.look(-1e-9, first)

    @property
    def unseen(self) -> tuple[str, ...]:
        """Objects that were not seen up to now."""
        return tuple(name for name, known in self._filters.items() if known.at(0.0) is None)

    def look(self, time: float, objects: Objects) -> Objects:
        """What is known of the objects at a time [s], while they are where they are."""
        rate, latency = self._perception.rate, self._perception.latency
        pictures = 0
        while self._next / rate <= time + 1e-9:
            self._take(self._next / rate, objects)
            self._next += 1
            pictures += 1
        arrived = False
        while self._coming and self._coming[0][0] + latency <= time + 1e-9:
            taken, name, pose = self._coming.popleft()
            self._filters[name].see(pose, taken)
            arrived = True
        if pictures or arrived:
            self._known = self._estimate(time, objects)
        return self._known

    def _take(self, time: float, objects: Objects) -> None:
        poses = {name: objects[name].pose for name in self._rows}
        for name, seen in self._perception._picture(poses, time, self._rng).items():
            self._coming.append((time, name, seen))

    def _estimate(self, time: float, objects: Objects) -> Objects:
        """Objects that were seen, with the covariance of their poses."""
        count = len(objects.positions)
        positions, quaternions = np.zeros((count, 3)), np.tile([1.0, 0, 0, 0], (count, 1))
        covariances, rows = np.zeros((count, 6, 6)), {}
        for name, row in self._rows.items():
            found = self._filters[name].at(time)
            if found is not None:
                rows[name] = row
                positions[row], quaternions[row] = found.pose.position, found.pose.quaternion
                covariances[row] = found.covariance
        return Objects(rows, positions, quaternions, covariances=covariances)
