"""Things that hands take and let go: free bodies, held by welds that close and open by themselves.

There are no fingers that squeeze. A hand closes where it has been near enough to its grasp for a
while, at rest; it then holds the thing rigidly, in the middle of the hand. It opens where the thing
is over its target, at rest again. Between, what is taken is a body of its own: it has a weight that
the controller's model does not know, it falls where it is let go, and it lies on what is below.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

from tpsim.border import Point, Positive, checked
from tpsim.errors import SimulationError
from tpsim.pose import Pose
from tpsim.robot.objects import Objects

TEXT = "grasps"
"""Name of the text of a scene in which its grasps are, as JSON."""

PERIOD = 0.01
"""Time between two looks of the hands at their things [s]."""


@dataclass(frozen=True)
class Grasp:
    """A thing that a hand takes, and where it lets it go.

    Parameters
    ----------
    model : str
        Of the thing: MJCF with a free joint, as :class:`~tpsim.scene.compose.Placed` takes it.
    site : str
        Of the hand.
    position, axes : (3,), two of (3,)
        Where the thing is in the hand: its origin [m], and its x and y axes.
    stand, on_stand : str, (3,)
        Object on which it stands at the start, and where there [m], turned as the stand.
    target, at_target : str, (3,)
        Object, or another thing, at which it is let go, and where its origin is there [m].
    closes, opens : (float, float, float)
        How near hand and grasp, thing and target have to be: across [m], up and down [m], and
        turned [rad], as the hand and the target see it.
    slow : float
        Speed [m/s], and a tenth of turning [rad/s], below which hands are at rest.
    dwell : float
        Time for which all that has to be so [s].
    away : float
        How far a hand has to be from where it took or left the thing before it looks again [m].
    """

    model: str
    site: str
    position: Point
    axes: tuple[Point, Point]
    stand: str
    on_stand: Point
    target: str
    at_target: Point
    closes: tuple[Positive, Positive, Positive] = (0.008, 0.008, 0.1)
    opens: tuple[Positive, Positive, Positive] = (0.008, 0.008, 0.1)
    slow: Positive = 0.02
    dwell: Positive = 0.25
    away: Positive = 0.06

    def __post_init__(self) -> None:
        checked(self)

    @property
    def in_hand(self) -> Pose:
        """Pose of the thing in the hand."""
        x, y = (np.array(axis) for axis in self.axes)
        return Pose(np.stack([x, y, np.cross(x, y)], axis=1), np.array(self.position))


def weld_name(thing: str) -> str:
    """Name of the weld that holds a thing."""
    return f"{thing} in hand"


def hands_site(thing: str) -> str:
    """Name of the site of a hand at which it holds a thing."""
    return f"{thing}_in_hand"


def write_grasps(spec: mujoco.MjSpec, grasps: Mapping[str, Grasp]) -> None:
    """Add to a scene what is needed to take the things that are in it already.

    Raises
    ------
    SimulationError
        If the scene has no such hand, stand or target.
    """
    for thing, grasp in grasps.items():
        hand = spec.site(grasp.site)
        if hand is None:
            known = ", ".join(site.name for site in spec.sites)
            raise SimulationError(
                f"'{thing}' is to be taken by site '{grasp.site}'; the scene has {known}"
            )
        for part, name in (("stand", grasp.stand), ("target", grasp.target)):
            if spec.body(name) is None:
                known = ", ".join(body.name for body in spec.bodies[1:])
                raise SimulationError(
                    f"{part} of '{thing}' is '{name}'; the scene has {known}: give an object of it"
                )
        R, p = grasp.in_hand
        turned = np.empty(4)
        mujoco.mju_mat2Quat(turned, R.ravel())
        at, facing = np.empty(3), np.empty(4)
        mujoco.mju_mulPose(at, facing, hand.pos, hand.quat, p, turned)
        hand.parent.add_site(name=hands_site(thing), pos=at, quat=facing, group=4)
        spec.add_equality(
            name=weld_name(thing),
            type=mujoco.mjtEq.mjEQ_WELD,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=hands_site(thing),
            name2=thing,
            active=False,
        )
    text = spec.add_text()
    text.name, text.data = TEXT, json.dumps({name: asdict(g) for name, g in grasps.items()})


def read_grasps(model: mujoco.MjModel) -> dict[str, Grasp]:
    """Grasps of a compiled scene by the names of the things; none in most scenes.

    Raises
    ------
    SimulationError
        If the scene says something else than grasps of what is in it.
    """
    found = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXT, TEXT)
    if found < 0:
        return {}
    first = int(model.text_adr[found])
    data = bytes(model.text_data[first : first + int(model.text_size[found]) - 1])
    try:
        said = json.loads(data.decode("utf-8"))
        return {name: _read(model, name, values) for name, values in said.items()}
    except (ValueError, TypeError, AttributeError, KeyError) as error:
        raise SimulationError(f"the scene's grasps cannot be read: {error}") from None


def _read(model: mujoco.MjModel, thing: str, values: dict[str, Any]) -> Grasp:
    grasp = Grasp(**{name: _tuples(value) for name, value in values.items()})
    joint = int(model.body_jntadr[model.body(thing).id])
    if joint < 0 or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_FREE:
        raise SimulationError(f"'{thing}' is to be taken by '{grasp.site}' and has no free joint")
    if model.body(grasp.stand).mocapid[0] < 0:
        raise SimulationError(f"'{thing}' stands on '{grasp.stand}', which is no movable object")
    model.body(grasp.target), model.equality(weld_name(thing)), model.site(hands_site(thing))
    return grasp


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


class Grasps:
    """The grasps of one simulation: which hand holds its thing, and how long it has been there.

    Parameters
    ----------
    model : MjModel

    Attributes
    ----------
    things : dict of str to int
        Address of each thing's pose (7,) in ``qpos``.
    geoms : (ngeom,) bool
        Which geoms are those of things.
    """

    def __init__(self, model: mujoco.MjModel):
        self._grasps = read_grasps(model)
        self.things = {
            name: int(model.jnt_qposadr[model.body(name).jntadr[0]]) for name in self._grasps
        }
        bodies = [model.body(name).id for name in self.things]
        self.geoms = np.isin(model.geom_bodyid, bodies)
        self._hands = [_Hand(model, name, grasp) for name, grasp in self._grasps.items()]
        self._poses = np.array([np.arange(k, k + 7) for k in self.things.values()], int)
        self._rows: dict[str, int] = {}
        self._every = max(1, round(PERIOD / model.opt.timestep))
        self._left = self._every

    def __bool__(self) -> bool:
        """Return whether there are any."""
        return bool(self._hands)

    def copy_from(self, other: "Grasps") -> None:
        """Take over who holds what for how long, in a simulation of the same scene."""
        self._left = other._left
        for mine, theirs in zip(self._hands, other._hands, strict=True):
            mine.waited, mine.away, mine.before = theirs.waited, theirs.away, theirs.before

    def begin(self, data: mujoco.MjData) -> None:
        """Put all things on their stands, which are where they begin; open all hands."""
        self._left = self._every
        for hand in self._hands:
            hand.begin(data)

    def see(self, objects: Objects, data: mujoco.MjData) -> Objects:
        """Objects with the things where they are now, taken as resting."""
        poses = data.qpos[self._poses]
        if len(self._rows) != len(objects) + len(poses):
            self._rows = {name: row for row, name in enumerate((*objects, *self.things))}
        positions = np.concatenate((objects.positions, poses[:, :3]))
        quaternions = np.concatenate((objects.quaternions, poses[:, 3:]))
        twists = objects.twists
        if twists is not None:
            twists = np.concatenate((twists, np.zeros((len(poses), 6))))
        return Objects(self._rows, positions, quaternions, twists)

    def act(self, data: mujoco.MjData) -> None:
        """After a time step: close and open hands where it is time to."""
        self._left -= 1
        if not self._left:
            self._left = self._every
            for hand in self._hands:
                hand.look(data, PERIOD)


class _Hand:
    """One hand with its thing."""

    def __init__(self, model: mujoco.MjModel, thing: str, grasp: Grasp):
        self._model, self._grasp = model, grasp
        self._thing, self._target = model.body(thing).id, model.body(grasp.target).id
        self._stand = int(model.body(grasp.stand).mocapid[0])
        self._site = model.site(hands_site(thing)).id
        self._weld = model.equality(weld_name(thing)).id
        self._qpos = int(model.jnt_qposadr[model.body(thing).jntadr[0]])
        self.waited, self.away = 0.0, True
        self.before: Pose | None = None

    def begin(self, data: mujoco.MjData) -> None:
        """Put the thing on its stand."""
        p, turned = data.mocap_pos[self._stand], data.mocap_quat[self._stand]
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, turned)
        place = data.qpos[self._qpos : self._qpos + 7]
        place[:3] = p + R.reshape(3, 3) @ self._grasp.on_stand
        place[3:] = turned
        data.eq_active[self._weld] = 0
        self.waited, self.away, self.before = 0.0, True, None

    def look(self, data: mujoco.MjData, period: float) -> None:
        """Close or open the hand where it has been at its place for long enough."""
        grasp, holds = self._grasp, bool(data.eq_active[self._weld])
        hand = Pose(data.site_xmat[self._site].reshape(3, 3), data.site_xpos[self._site])
        thing = Pose(data.xmat[self._thing].reshape(3, 3), data.xpos[self._thing])
        if holds:
            over = Pose(data.xmat[self._target].reshape(3, 3), data.xpos[self._target])
            base, seen, place, within = over, thing, grasp.at_target, grasp.opens
        else:
            base, seen, place, within = thing, hand, (0.0, 0.0, 0.0), grasp.closes
        slow = self._slow(hand, period)
        x, y, z = (base.rotation.T.dot(seen.position - base.position) - place).tolist()
        self.away = self.away or x * x + y * y + z * z > grasp.away**2
        ready = slow and self.away and _near(x, y, z, base, seen, within)
        self.waited = self.waited + period if ready else 0.0
        if self.waited >= grasp.dwell:
            data.eq_active[self._weld] = not holds
            # What was just taken is still at its target, what was just left is still in the hand.
            self.waited, self.away = 0.0, False

    def _slow(self, hand: Pose, period: float) -> bool:
        before, self.before = self.before, Pose(*(part.copy() for part in hand))
        if before is None:
            return False
        most, moved = self._grasp.slow * period, (hand.position - before.position).tolist()
        if math.hypot(*moved) >= most:
            return False
        turned = np.linalg.norm(hand.rotation - before.rotation) / math.sqrt(2)
        return bool(turned < 10 * most)


def _near(
    x: float, y: float, z: float, base: Pose, seen: Pose, within: tuple[float, float, float]
) -> bool:
    across, along, turned = within
    if x * x + y * y > across * across or abs(z) > along:
        return False
    return bool(np.linalg.norm(pin.log3(base.rotation.T @ seen.rotation)) <= turned)
