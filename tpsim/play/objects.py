"""Objects that are led by hand while time passes, and the paths that repeat it."""

from collections.abc import Hashable, Sequence

import numpy as np

from tpsim import rotation
from tpsim.pose import Pose
from tpsim.robot.objects import Objects
from tpsim.world.object_path import MovingObjects, ObjectPath, velocities
from tpsim.world.people.drag import Quaternion
from tpsim.world.simulation import Simulation

BLOCK = 0.01
"""Time [s] for which it is decided ahead where a led object goes."""

LAG = 0.06
"""Time constant [s] with which an object follows the hand: its velocity has no jumps."""

NEAR = 1e-5
"""Distance [m] at which an object has arrived."""


Via = tuple[float, np.ndarray, np.ndarray]
"""Time [s], position (3,) [m] and quaternion (4,)."""


class LedObjects:
    """Objects on their paths, until somebody takes one: from then on it goes where it is led.

    Parameters
    ----------
    paths : sequence of ObjectPath
    simulation : Simulation

    Attributes
    ----------
    now : Objects
        Poses and velocities at the last :meth:`act`.
    """

    def __init__(self, paths: Sequence[ObjectPath], simulation: Simulation):
        self._paths = {path.name: path for path in paths}
        self._scripted = MovingObjects(paths, simulation)
        self._simulation, self._rows = simulation, simulation.objects
        self._block = max(1, round(BLOCK / simulation.timestep))
        self._led: dict[str, _Led] = {}
        self._taken: dict[Hashable, tuple[str, np.ndarray]] = {}
        self._step = -1
        self.now = self._scripted.now

    def act(self, step: int) -> None:
        """Move the objects to their poses at a time step; each step once, in order."""
        self._scripted.act(step)
        before, self._step, self.now = self.now, step, self._scripted.now
        if not self._led:
            return
        data, h = self._simulation.data, self._simulation.timestep
        positions, turned = self.now.positions.copy(), self.now.quaternions.copy()
        for name, led in self._led.items():
            row = self._rows[name]
            positions[row], turned[row] = led.at(step)
        data.mocap_pos[:], data.mocap_quat[:] = positions, turned
        twists = velocities(
            np.stack([before.positions, positions]), np.stack([before.quaternions, turned]), h
        )[1]
        self.now = Objects(self._rows, positions, turned, twists)

    def take(self, who: Hashable, name: str, where: np.ndarray) -> None:
        """Take hold of an object at a point of the world (3,) [m]."""
        self._taken[who] = name, np.array(where, float) - self.pose(name).position

    def move(self, who: Hashable, where: np.ndarray, turned: Quaternion | None = None) -> bool:
        """Lead what somebody holds, so that the point held goes there; False if it is nothing."""
        if who not in self._taken:
            return False
        name, offset = self._taken[who]
        self.want(name, np.asarray(where, float) - offset, turned)
        return True

    def let_go(self, who: Hashable) -> None:
        """Let go; of no use to who holds nothing."""
        self._taken.pop(who, None)

    @property
    def takers(self) -> set[Hashable]:
        """Those who hold an object now."""
        return set(self._taken)

    def want(self, name: str, position: np.ndarray, quaternion: Quaternion | None = None) -> None:
        """Lead an object to a pose; it keeps how it is turned by default."""
        if name not in self._led:
            first = max(self._step, 0)
            begun = self._vias(name, first)
            self._led[name] = _Led(begun, first, self._block, self._simulation.timestep)
        led = self._led[name]
        led.goal = np.array(position, float)
        if quaternion is not None:
            led.turn = np.array(quaternion, float)

    def paths(self) -> tuple[ObjectPath, ...]:
        """Where all objects were since the first step; at the end of these paths they rest."""
        led = {name: found.path(name) for name, found in self._led.items()}
        return tuple({**self._paths, **led}.values())

    def resting(self) -> tuple[ObjectPath, ...]:
        """All objects at rest where they are now."""
        return tuple(
            ObjectPath.at(name, self.now.positions[row], self.now.quaternions[row])
            for name, row in self._rows.items()
        )

    def pose(self, name: str) -> Pose:
        """Where an object is."""
        return self.now[name].pose

    def _vias(self, name: str, step: int) -> list[Via]:
        """Vias of an object up to a time step: one a step where its path moves."""
        path, h, row = self._paths.get(name), self._simulation.timestep, self._rows[name]
        if path is None:
            return [(h * step, self.now.positions[row], self.now.quaternions[row])]
        if len(path.times) == 1:
            assert path.quaternions is not None
            return [(h * step, np.array(path.positions[0]), np.array(path.quaternions[0]))]
        times = h * np.arange(step + 1)
        return list(zip(times.tolist(), *path.poses(times), strict=True))


class _Led:
    """One object that is led: vias are decided a block ahead, and it moves straight between."""

    def __init__(self, begun: list[Via], step: int, block: int, timestep: float):
        self._vias, (_, goal, turn) = begun, begun[-1]
        self.goal, self.turn = goal.copy(), turn.copy()
        self._until, self._block, self._h = step, block, timestep
        self._share = 1 - np.exp(-block * timestep / LAG)
        self._samples = ObjectPath("led", *_columns(begun[-1:])).poses([timestep * step])

    def at(self, step: int) -> tuple[np.ndarray, np.ndarray]:
        """Position and quaternion at a time step."""
        if step > self._until:
            self._decide(step)
        positions, turned = self._samples
        k = min(len(positions) - 1 - (self._until - step), len(positions) - 1)
        return positions[k], turned[k]

    def _decide(self, step: int) -> None:
        """Where it is after the block that begins at the step before this one."""
        _, p, turned = self._vias[-1]
        left = self.goal - p
        goal = self.turn if self.turn @ turned >= 0 else -self.turn
        turning = goal - turned
        if max(np.abs(left).max(), np.abs(turning).max()) == 0:
            return
        near = max(np.linalg.norm(left), np.linalg.norm(turning)) < NEAR
        first, share = step - 1, 1.0 if near else self._share
        # A via where it rested: what was decided before ended there.
        if first > self._until:
            self._vias.append((self._h * first, p, turned))
        blended = turned + share * turning
        there = p + share * left if not near else self.goal.copy()
        turned_to = goal.copy() if near else blended / np.linalg.norm(blended)
        self._until = first + self._block
        self._vias.append((self._h * self._until, there, turned_to))
        last = ObjectPath("led", *_columns(self._vias[-2:]))
        self._samples = last.poses(self._h * np.arange(first, self._until + 1))

    def path(self, name: str) -> ObjectPath:
        """All of it."""
        return ObjectPath(name, *_columns(self._vias))


def _columns(vias: list[Via]) -> tuple[tuple, tuple, tuple]:
    """Positions, times and quaternions of vias."""
    times, positions, quaternions = zip(*vias, strict=True)
    turned = rotation.continuous(np.array(quaternions))
    return (
        tuple(tuple(p.tolist()) for p in positions),
        times,
        tuple(tuple(q.tolist()) for q in turned),
    )
