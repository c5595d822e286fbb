"""Hands found in a file that does not say which they are."""

from collections.abc import Iterator

import mujoco
import numpy as np

from tpsim.catalogue.arms import Arms, Side
from tpsim.errors import ArgumentError
from tpsim.robot.gripper import Gripper
from tpsim.robot.reading import compiled, name_elements

FEWEST = 4
"""Joints of an arm, at least: fewer are fingers, a neck, or a wheel."""

TIP = 0.02
"""How far before the tips of the fingers a hand grips [m]."""

_KINDS = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)


def arms_in(spec: mujoco.MjSpec, what: str) -> Arms:
    """Arms of a file: chains of at least four joints, each up to where fingers begin.

    A hand reaches along that axis of its body which leads most nearly from the last joint to the
    tips of the hand, and grips a little before these. Of two arms, the left one has the larger y.

    Raises
    ------
    ArgumentError
        If there are neither one nor two arms, or they are not fixed to the world.
    """
    name_elements(spec)
    for body in spec.bodies[1:]:
        if not body.name:
            body.name = f"body{body.id}"
    model = compiled(spec)
    if mujoco.mjtJoint.mjJNT_FREE in model.jnt_type:
        raise ArgumentError(f"{what} has a free base; tasks need arms that are fixed to the world")
    ends = list(_ends(model))
    if not 1 <= len(ends) <= 2:
        found = ", ".join(model.body(end).name for end in ends) or "none"
        raise ArgumentError(
            f"{what} has {len(ends)} arms of {FEWEST} joints or more ({found}), and tasks need one "
            "or two: describe them in Python, my_arms.py:name, as docs/recipes/robot.md shows"
        )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    ends.sort(key=lambda end: -data.xanchor[_chain(model, end)[0], 1])
    sides: tuple[Side, ...] = ("left", "right")
    pairs = list(zip(sides, ends, strict=False))
    return Arms(spec, {side: _gripper(model, data, end) for side, end in pairs})


def _chain(model: mujoco.MjModel, body: int) -> list[int]:
    """Hinges and slides above a body, the first one first."""
    joints: list[int] = []
    while body:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = list(range(first, first + count)) + joints
        body = int(model.body_parentid[body])
    return joints


def _ends(model: mujoco.MjModel) -> Iterator[int]:
    """Bodies of the hands: the last of each chain before it forks, or ends."""
    children: dict[int, list[int]] = {}
    for body in range(1, model.nbody):
        children.setdefault(int(model.body_parentid[body]), []).append(body)

    def deepest(body: int) -> int:
        own = int(model.body_jntnum[body])
        return own + max((deepest(child) for child in children.get(body, ())), default=0)

    def walk(body: int, joints: int, last: int) -> Iterator[int]:
        own = int(model.body_jntnum[body])
        joints, last = joints + own, body if own else last
        moving = [child for child in children.get(body, ()) if deepest(child)]
        long = [child for child in moving if deepest(child) >= FEWEST]
        if joints >= FEWEST and (len(moving) != 1 or _is_finger(model, moving[0], deepest)):
            yield body if len(moving) > 1 else last
        else:
            for child in long if len(moving) > 1 else moving:
                yield from walk(child, joints, last)

    for root in children.get(0, ()):
        yield from walk(root, 0, 0)


def _is_finger(model: mujoco.MjModel, body: int, deepest: object) -> bool:
    """Whether the only joint beyond is that of a finger: a slide."""
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    return count == 1 and int(model.jnt_type[first]) == mujoco.mjtJoint.mjJNT_SLIDE


def _gripper(model: mujoco.MjModel, data: mujoco.MjData, body: int) -> Gripper:
    """Where a hand grips, in its body's frame."""
    R, p = data.xmat[body].reshape(3, 3), data.xpos[body]
    shapes = [g for g in range(model.ngeom) if _carries(model, body, int(model.geom_bodyid[g]))]
    points = [p]
    for geom in shapes:
        centre, half = np.split(model.geom_aabb[geom], 2)
        Rg = data.geom_xmat[geom].reshape(3, 3)
        corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        points.extend(data.geom_xpos[geom] + (centre + corners * half) @ Rg.T)
    cloud = (np.array(points) - p) @ R
    reach: np.ndarray = np.zeros(3)
    middle = cloud.mean(0)
    axis = int(np.abs(middle).argmax())
    reach[axis] = np.sign(middle[axis]) or 1.0
    tip = float((cloud @ reach).max())
    across = _across(model, data, body, R, axis)
    x, y, z = (max(tip - TIP, 0.0) * reach).tolist()
    a, b, c = reach.tolist()
    d, e, f = across.tolist()
    return Gripper(model.body(body).name, (x, y, z), (a, b, c), (d, e, f))


def _across(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, R: np.ndarray, reach: int
) -> np.ndarray:
    """Axis of the hand's body along which its fingers move: slides do, hinges turn about it."""
    way = np.zeros(3)
    for joint in range(model.njnt):
        carrier = int(model.jnt_bodyid[joint])
        if carrier != body and _carries(model, body, carrier):
            axis = R.T @ data.xaxis[joint]
            if int(model.jnt_type[joint]) == mujoco.mjtJoint.mjJNT_HINGE:
                axis = np.cross(axis, np.eye(3)[reach])
            way += np.abs(axis)
    way[reach] = 0.0
    across = np.zeros(3)
    across[int(way.argmax()) if way.any() else (reach + 1) % 3] = 1.0
    return across


def _carries(model: mujoco.MjModel, body: int, other: int) -> bool:
    while other and other != body:
        other = int(model.body_parentid[other])
    return other == body
