"""A hand that pulls a body where its person wants it at the moment: a mouse, live or recorded."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np
import pinocchio as pin

from tpsim.border import Duration, Endless, Point, checked
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.people.guide import Grip, carried
from tpsim.world.people.sight import Moving
from tpsim.world.simulation import Simulation

Quaternion = tuple[float, float, float, float]
"""(w, x, y, z)"""

UPRIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)

PULL = Grip(600.0, 40.0, 0.0, 0.0, 60.0, 0.0)
"""A finger that pulls at a point."""


@dataclass(frozen=True)
class Drag:
    """A spring with limited strength between a point of a body and where a person wants it.

    What is wanted changes at some times, as a mouse moves, and is followed with a lag that makes
    its jumps smooth. The values are plain: what was done live is done again from them, bit for bit.

    Parameters
    ----------
    name : str
        What the recording calls it: ``<name>_wrench``, ``<name>_point``.
    body : str
        Body or site that is held.
    times : tuple of float
        When the person wants something else [s], increasing; the first is when it takes hold.
    positions : tuple of (3,)
        Where it wants the point from then on [m].
    quaternions : tuple of (4,), optional
        How it wants the body or site turned (w, x, y, z); it turns freely by default.
    until : float
        When it lets go [s].
    point : (3,)
        Where it is held, in the frame of the body or site [m].
    grip : Grip
    relative_to : str, optional
        Body or site in whose frame it wants the point: a hand that follows another one.
    smoothing : float
        Time constant of the lag [s].

    Raises
    ------
    ArgumentError
        Lengths that do not fit, or times that do not increase.
    """

    name: str
    body: str
    times: tuple[float, ...]
    positions: tuple[Point, ...]
    quaternions: tuple[Quaternion, ...] | None = None
    until: Endless = np.inf
    point: Point = (0.0, 0.0, 0.0)
    grip: Grip = PULL
    relative_to: str | None = None
    smoothing: Duration = 0.04

    def __post_init__(self) -> None:
        checked(self)
        turned = self.times if self.quaternions is None else self.quaternions
        if not self.times or not len(self.times) == len(self.positions) == len(turned):
            raise ArgumentError(
                f"drag has {len(self.times)} times, {len(self.positions)} positions and "
                f"{len(turned)} quaternions; give as many of each, at least one"
            )
        if self.times[0] < 0 or (np.diff(self.times) <= 0).any():
            raise ArgumentError("drag times must increase, from 0 on")
        if self.quaternions is not None and not np.linalg.norm(self.quaternions, axis=1).all():
            raise ArgumentError("drag quaternions: one of them is zero; give unit quaternions")

    def bind(self, simulation: Simulation) -> "BoundDrag":
        """Look up the names in one simulation."""
        return BoundDrag(self, simulation)


class BoundDrag:
    """A drag in one simulation, which may be told what is wanted while it goes.

    Parameters
    ----------
    drag : Drag
        Who holds what, and how.
    simulation : Simulation

    Attributes
    ----------
    wrench, point : (6,), (3,)
        The last, zero where nobody pulls.
    """

    def __init__(self, drag: Drag, simulation: Simulation):
        self.name, self._drag, self._simulation = drag.name, drag, simulation
        self._held = _Place(simulation, drag.body, drag.point)
        other = drag.relative_to
        self._other = None if other is None else _Place(simulation, other, (0.0, 0.0, 0.0))
        self._share = 1 - np.exp(-simulation.timestep / drag.smoothing)
        self._steps: list[int] = []
        self._said: list[tuple[Point, Quaternion]] = []
        self._wanted: list[Pose] = []
        self._at, self._next = Pose(np.eye(3), np.zeros(3)), 0
        self.wrench, self.point = np.zeros(6), np.zeros(3)
        turned = drag.quaternions or (UPRIGHT,) * len(drag.times)
        for time, position, quaternion in zip(drag.times, drag.positions, turned, strict=True):
            self.want(round(time / simulation.timestep), position, quaternion)
        self._end: int | None = None
        if np.isfinite(drag.until):
            self.let_go(round(drag.until / simulation.timestep))

    def want(self, step: int, position: Point, quaternion: Quaternion = UPRIGHT) -> None:
        """From a time step on, want the point somewhere else; of one step, the last word counts."""
        if self._steps and self._steps[-1] >= step:
            del self._steps[-1], self._said[-1], self._wanted[-1]
        self._steps.append(step)
        self._said.append((position, quaternion))
        self._wanted.append(Pose.of_quaternion(np.array(position), np.array(quaternion)))

    def let_go(self, step: int) -> None:
        """Let go at a time step."""
        self._end = step

    @property
    def held(self) -> bool:
        """Whether nobody said when it lets go."""
        return self._end is None

    @property
    def body(self) -> str:
        """Body or site that is held."""
        return self._drag.body

    @property
    def held_at(self) -> Point:
        """Where it is held, in the frame of the body or site [m]."""
        return self._drag.point

    @property
    def turned(self) -> Quaternion:
        """How the body is wanted now."""
        return self._said[-1][1]

    @property
    def target(self) -> np.ndarray:
        """Where the point is wanted (3,) [m], in the world or the frame of ``relative_to``."""
        return self._wanted[-1].position

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of this time step."""
        over = self._end is not None and step >= self._end
        if over or step < self._steps[0]:
            self.wrench, self.point = np.zeros(6), np.zeros(3)
            return
        pose, twist = self._held.moving()
        wanted, wanted_twist = self._follow(step)
        if self._drag.quaternions is None:
            wanted = Pose(pose.rotation, wanted.position)
            wanted_twist = np.concatenate([wanted_twist[:3], twist[3:]])
        self.wrench = self._drag.grip.wrench(pose, twist, wanted, wanted_twist)
        self.point = pose.position
        self._simulation.apply_wrench(self._held.body, self.wrench, self.point)

    def _follow(self, step: int) -> Moving:
        """Pose and twist to which the spring pulls: what is wanted, with a lag."""
        while self._next < len(self._steps) and self._steps[self._next] <= step:
            if self._next == 0:
                self._at = self._wanted[0]
            self._next += 1
        goal, (R, p) = self._wanted[self._next - 1], self._at
        v = self._share * (goal.position - p)
        w = self._share * pin.log3(goal.rotation @ R.T)
        self._at = Pose(pin.exp3(w) @ R, p + v)
        h = self._simulation.timestep
        frame = None if self._other is None else self._other.moving()
        return carried(*self._at, v / h, w / h, frame)

    def value(self, last: int) -> Drag:
        """What was done up to a time step."""
        h, drag = self._simulation.timestep, self._drag
        positions, turned = zip(*self._said, strict=True)
        return replace(
            drag,
            times=tuple(h * step for step in self._steps),
            positions=positions,
            quaternions=None if drag.quaternions is None else turned,
            until=h * (last if self._end is None else min(self._end, last)),
        )


class _Place:
    """A point of a body or site: where it is and how it moves."""

    def __init__(self, simulation: Simulation, name: str, point: Point):
        self.body, self._R, p = simulation.attachment(name)
        self._p = p + self._R @ np.array(point)
        self._simulation, self._velocity = simulation, np.zeros(6)

    def moving(self) -> Moving:
        """Pose and twist (6,): linear over angular velocity, world-aligned."""
        data, found = self._simulation.data, self._velocity
        R = data.xmat[self.body].reshape(3, 3)
        arm = R @ self._p
        kind = mujoco.mjtObj.mjOBJ_XBODY
        mujoco.mj_objectVelocity(self._simulation.model, data, kind, self.body, found, 0)
        w = found[:3].copy()
        return Pose(R @ self._R, data.xpos[self.body] + arm), np.concatenate(
            [found[3:] + np.cross(w, arm), w]
        )
