"""Objects that move by themselves: mocap bodies along scripted paths."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from tpsim import rotation
from tpsim.border import border, read
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.timeline import around
from tpsim.world.simulation import Simulation

FAST = 2.0
"""Speed [m/s] above which an object has jumped: its velocity then says nothing."""

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
"""Quaternion of an object that is not turned."""

BLOCK = 1000
"""Time steps whose poses are computed at once: a trial that ends early has not paid for all."""


@dataclass(frozen=True)
class ObjectPath:
    """Where one object of the scene is over time; plain values, so that a situation can keep it.

    Parameters
    ----------
    name : str
        A mocap body of the scene.
    positions : (V, 3) nested tuple
        Where it is at the times [m]. One position is an object at rest.
    times : (V,) tuple
        Not decreasing [s]. Between two times the object moves straight and turns evenly; two
        equal times are a jump. Before the first and after the last it rests.
    quaternions : (V, 4) nested tuple, optional
        How it is turned (w, x, y, z); not at all by default.

    Raises
    ------
    ArgumentError
        Shapes that do not fit, numbers that are not finite, or times that decrease.
    """

    name: str
    positions: tuple[tuple[float, float, float], ...]
    times: tuple[float, ...] = (0.0,)
    quaternions: tuple[tuple[float, float, float, float], ...] | None = None

    def __post_init__(self) -> None:
        read("name", self.name, str)
        label = f"object {shown(self.name)}: "
        positions = finite_array(f"{label}positions", self.positions)
        times = finite_array(f"{label}times", self.times)
        given = (UPRIGHT,) * times.size if self.quaternions is None else self.quaternions
        turned = finite_array(f"{label}quaternions", given)
        count = times.size
        shapes = times.shape, positions.shape, turned.shape
        if not count or shapes != ((count,), (count, 3), (count, 4)):
            raise ArgumentError(
                f"object {shown(self.name)} has times, positions and quaternions of shapes "
                f"{shapes}; give (V,), (V, 3) and (V, 4)"
            )
        if (np.diff(times) < 0).any() or not np.linalg.norm(turned, axis=1).all():
            raise ArgumentError(
                f"object {shown(self.name)} has quaternions of which one is zero, or "
                f"times {shown(times)} that decrease"
            )
        object.__setattr__(self, "times", tuple(times.tolist()))
        object.__setattr__(self, "positions", tuple(map(tuple, positions.tolist())))
        object.__setattr__(self, "quaternions", tuple(map(tuple, turned.tolist())))

    @classmethod
    @border
    def at(cls, name: str, position: ArrayLike, quaternion: ArrayLike = UPRIGHT) -> "ObjectPath":
        """An object at rest."""
        p, turned = finite_array("position", position), finite_array("quaternion", quaternion)
        if p.shape != (3,) or turned.shape != (4,):
            raise ArgumentError(
                f"position has shape {p.shape} and quaternion {turned.shape}; give (3,) and (4,)"
            )
        return cls(name, (tuple(p.tolist()),), (0.0,), (tuple(turned.tolist()),))

    @property
    def first(self) -> Pose:
        """Where the object is at the start."""
        position, turned = self.poses([0.0])
        return Pose.of_quaternion(position[0], turned[0])

    def poses(self, times: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Positions (T, 3) [m] and quaternions (T, 4) at times (T,) [s]."""
        times = finite_array("times", times)
        if times.ndim != 1:
            raise ArgumentError(f"times have shape {times.shape}; give (T,)")
        return _Waypoints(self).poses(times)


class _Waypoints:
    """Where a path leads through, as arrays, made once for all times that are asked for.

    Attributes
    ----------
    rest : bool
        Whether the object never moves.
    """

    def __init__(self, path: ObjectPath):
        self._times, self._positions = np.array(path.times), np.array(path.positions)
        turned = np.array(path.quaternions)
        size = np.linalg.norm(turned, axis=1, keepdims=True)
        # What is a unit already stays as it is, so that poses of this path make the same path.
        turned = turned / np.where(np.abs(size - 1) < 1e-12, 1.0, size)
        self._quaternions = rotation.continuous(turned)
        ways = self._positions, self._quaternions
        self.rest = not any(np.ptp(way, axis=0).any() for way in ways)

    def poses(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions (T, 3) [m] and quaternions (T, 4) at times (T,) [s]."""
        before, after, share = around(self._times, times)
        # At rest there is no way to go, and nothing that rounding errors could come from.
        share = np.where(before == after, 0.0, share)[:, None]
        p, turned = self._positions, self._quaternions
        position: np.ndarray = p[before] + share * (p[after] - p[before])
        return position, _slerp(turned[before], turned[after], share)


class MovingObjects:
    """The objects of a simulation on their paths; those without one stay where they are.

    Parameters
    ----------
    paths : sequence of ObjectPath
    simulation : Simulation

    Attributes
    ----------
    now : Objects
        Poses and velocities at the last :meth:`act`.

    Raises
    ------
    ArgumentError
        If the scene has no movable object of a path's name.
    """

    def __init__(self, paths: Sequence[ObjectPath], simulation: Simulation):
        names = list(simulation.objects)
        if unknown := [path.name for path in paths if path.name not in names]:
            raise ArgumentError(
                f"no movable object {shown(unknown[0])} in the scene; it has {sorted(names)}"
            )
        h, model, data = simulation.timestep, simulation.model, simulation.data
        last = max((path.times[-1] for path in paths), default=0.0)
        # At least one step, so that all objects are somewhere.
        self._steps = round(max(last, 0.0) / h) + 2 if paths else 1
        movable = np.flatnonzero(model.body_mocapid >= 0)
        movable = movable[np.argsort(model.body_mocapid[movable])]
        self._home = model.body_pos[movable], model.body_quat[movable]
        self._ways = [(simulation.objects[path.name], _Waypoints(path)) for path in paths]
        self._rest = all(way.rest for _, way in self._ways)
        self._timestep, self._rows = h, simulation.objects
        self._mocap = data.mocap_pos, data.mocap_quat
        self._compute(0)
        self.now = self._at(0)

    def _compute(self, first: int) -> None:
        """Poses and velocities of a block of time steps."""
        # Velocities are since the step before, which the block begins with.
        before = min(first, 1)
        steps = np.arange(first - before, min(first + BLOCK, self._steps))
        positions, quaternions = (np.tile(start, (len(steps), 1, 1)) for start in self._home)
        for row, way in self._ways:
            positions[:, row], quaternions[:, row] = way.poses(self._timestep * steps)
        twists = None if self._rest else velocities(positions, quaternions, self._timestep)
        if twists is not None and steps[-1] == self._steps - 1:
            # It rests at the end of its path.
            twists[-1] = 0.0
        self._first = first
        self._positions, self._quaternions = positions[before:], quaternions[before:]
        self._twists = None if twists is None else twists[before:]

    def moved_to(self, simulation: Simulation) -> "MovingObjects":
        """The same objects, as they are now, in another simulation of the same scene."""
        other = copy.copy(self)
        other._mocap = simulation.data.mocap_pos, simulation.data.mocap_quat
        return other

    def _at(self, step: int) -> Objects:
        if not 0 <= (row := step - self._first) < BLOCK:
            row = step % BLOCK
            self._compute(step - row)
        twists = None if self._twists is None else self._twists[row]
        return Objects(self._rows, self._positions[row], self._quaternions[row], twists)

    def act(self, step: int) -> None:
        """Move the objects to their poses at this time step."""
        if step >= self._steps or (self._rest and step > 1):
            return
        positions, quaternions = self._mocap
        self.now = now = self._at(step)
        positions[:], quaternions[:] = now.positions, now.quaternions


def put_objects(paths: Sequence[ObjectPath], simulation: Simulation) -> None:
    """Put objects where their paths begin, and look what touches then."""
    if paths:
        MovingObjects(paths, simulation).act(0)
        mujoco.mj_forward(simulation.model, simulation.data)


def velocities(positions: np.ndarray, quaternions: np.ndarray, timestep: float) -> np.ndarray:
    """Velocities (T, k, 6) [m/s], [rad/s] since the step before; a jump is no motion."""
    moved = np.diff(positions, axis=0, prepend=positions[:1]) / timestep
    turned = np.diff(quaternions, axis=0, prepend=quaternions[:1])
    # omega = 2 dq q^*, of which the vector part counts.
    w, v = quaternions[..., :1], quaternions[..., 1:]
    dw, dv = turned[..., :1], turned[..., 1:]
    omega = 2 * (w * dv - dw * v - np.cross(dv, v)) / timestep
    twists = np.concatenate((moved, omega), axis=-1)
    twists[np.linalg.norm(moved, axis=-1) > FAST] = 0.0
    return twists


def _slerp(one, other, share):
    """Quaternions (T, 4) that turn evenly from one to another of the same half sphere."""
    angle = np.arccos(np.clip((one * other).sum(-1, keepdims=True), -1.0, 1.0))
    # Of a turn so small that its sine vanishes, the chord is the arc.
    sine = np.where(angle > 1e-6, np.sin(angle), 1.0)
    left = np.where(angle > 1e-6, np.sin((1 - share) * angle), 1 - share) / sine
    right = np.where(angle > 1e-6, np.sin(share * angle), share) / sine
    return left * one + right * other
