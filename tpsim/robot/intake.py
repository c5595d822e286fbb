"""Intake: a robot's file of whatever kind becomes a torque-controlled robot, alone and whole."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import mujoco
import numpy as np

from tpsim import border, checks
from tpsim.checks import shown
from tpsim.errors import ArgumentError
from tpsim.robot.actuators import torque_motors
from tpsim.robot.assets import embed
from tpsim.robot.gripper import Gripper, add_grippers
from tpsim.robot.holding import check_holds, exclude_touching
from tpsim.robot.home import Home, keyframe, known_positions, rest
from tpsim.robot.kinematic_chain import arm_joints
from tpsim.robot.limits import Limit, limits, motor_limits, velocity_limits
from tpsim.robot.others import controls, split
from tpsim.robot.posture import find_home
from tpsim.robot.reading import Draft, compiled, name_elements, read
from tpsim.robot.reduction import lock
from tpsim.robot.removal import drop_gravity_compensation, drop_keyframes, remove_idle
from tpsim.robot.urdf import read_urdf


@dataclass(frozen=True)
class Source:
    """A robot taken in: each arm joint has one motor, whose control is its torque.

    Attributes
    ----------
    spec : MjSpec
        The robot alone; copy it before use. Motors' control ranges are the torque limits.
    assets : mapping of str to bytes
        Content of every file that the spec's text refers to, by the name there.
    hands : mapping of str to str
        Site of each hand.
    joints : tuple of str
        The arm joints, n, in model order.
    velocity_limit : (n,)
        rad/s or m/s; infinite where unknown.
    home : (n,)
        Home posture, rad or m.
    others : mapping of str to float
        Joints that are no arm and move under their own servos, with the position at home.
    controls : mapping of str to float
        Actuators that are no arm motor, with the control that keeps ``others`` at home.
    changes : tuple of str
        What the intake changed or removed, one line each.
    """

    spec: mujoco.MjSpec
    assets: Mapping[str, bytes]
    hands: Mapping[str, str]
    joints: tuple[str, ...]
    velocity_limit: np.ndarray
    home: np.ndarray
    others: Mapping[str, float]
    controls: Mapping[str, float]
    changes: tuple[str, ...]


def take_in(
    source: str | Path | mujoco.MjSpec,
    *,
    hands: Mapping[str, str | Gripper],
    torque_limit: Limit = None,
    velocity_limit: Limit = None,
    home: Home = None,
    others: Literal["locked", "servo"] = "locked",
) -> Source:
    """Make a torque-controlled robot of an MJCF file, MJCF text or a spec.

    Parameters
    ----------
    source : str, Path or MjSpec
        Path of an MJCF file, MJCF text (it starts with ``<``), or a spec, which is not changed.
    hands : mapping of str to str or Gripper
        Site of each hand by the hand's name, or where it grips. The joints between the world and
        the hands are the arm joints, n.
    torque_limit : number, mapping, (n,) or None
        Nm or N, see :data:`~tpsim.robot.limits.Limit`. ``None``, and joints that a mapping leaves
        out: what the file states by forcerange, actuatorfrcrange, ctrlrange and gear.
    velocity_limit : number, mapping, (n,) or None
        rad/s or m/s; infinite where it is not given, as MJCF has no such limits.
    home : mapping, (n,) or None
        Home posture, rad or m. ``None``: the file's keyframe "home", else its only keyframe, else
        a posture in the middle of the ranges that the motors hold easily.
    others : {"locked", "servo"}
        Whether joints that are no arm are removed at their home position, or stay with their own
        actuators; what no actuator drives is locked in any case.

    Raises
    ------
    ArgumentError
        If the source does not compile, or cannot be a torque-controlled arm: one line says why,
        what the file has, and what to do.
    """
    border.read("hands", hands, Mapping[str, str | Gripper])
    return _take_in(read(source), hands, torque_limit, velocity_limit, home, others)


def take_in_urdf(
    path: str | Path,
    *,
    hands: Mapping[str, str | Gripper],
    packages: Mapping[str, str | Path] | None = None,
    torque_limit: Limit = None,
    velocity_limit: Limit = None,
    home: Home = None,
) -> Source:
    """Make a torque-controlled robot of a URDF file.

    The file's effort, velocity and damping are taken over. Joints that are no arm are locked, as
    a URDF has no servos; links that touch at home, as neighbours often do, do not collide.

    Parameters
    ----------
    path : str or Path
        The URDF file.
    hands : mapping of str to str or Gripper
        Link of each hand by the hand's name, where its site gets the link's name and frame; or
        where it grips.
    packages : mapping of str to path, optional
        See :func:`~tpsim.robot.urdf.read_urdf`.
    torque_limit, velocity_limit, home
        See :func:`take_in`.

    Raises
    ------
    ArgumentError
        If the file cannot be read or be a torque-controlled arm; one line says why.
    """
    border.read("hands", hands, Mapping[str, str | Gripper])
    border.read("packages", packages, Mapping[str, str | Path] | None)
    path = checks.path("path", path)
    draft = read_urdf(path, packages, hands.values())
    source = _take_in(draft, hands, torque_limit, velocity_limit, home, "locked")
    excluded = exclude_touching(source.spec, dict(zip(source.joints, source.home, strict=True)))
    return replace(source, changes=(*source.changes, *excluded))


def _take_in(
    draft: Draft,
    grips: Mapping[str, str | Gripper],
    torque_limit: Limit,
    velocity_limit: Limit,
    home: Home,
    others: Literal["locked", "servo"],
) -> Source:
    if not isinstance(others, str) or others not in ("locked", "servo"):
        raise ArgumentError(f"others is {shown(others)}, but must be 'locked' or 'servo'")
    spec = draft.spec
    hands = add_grippers(spec, grips)
    name_elements(spec)
    model = compiled(spec)
    assets = embed(spec, model)
    joints = arm_joints(model, hands)
    torque = limits(torque_limit, joints, "torque_limit")
    velocity = velocity_limits(velocity_limit, draft.velocity_limit, joints)
    known = known_positions(model, joints, home)
    positions = rest(model, known)
    locked, kept = split(model, joints, hands, others)
    held = controls(spec, model, kept, positions, keyframe(model))
    changes = [*draft.changes, *drop_keyframes(spec, model)]
    changes += drop_gravity_compensation(spec, model)
    changes += lock(spec, model, {name: positions.get(name) for name in locked})
    changes += remove_idle(spec, compiled(spec)) if locked else []
    changes += torque_motors(spec, model, joints, torque)
    at_rest = {name: positions[name] for name in kept}
    given = {name: position for name, position in known.items() if name in joints}
    if len(given) < len(joints):
        changes.append("home posture: found in the middle of the ranges")
    posture = _home(compiled(spec), joints, hands, given, at_rest)
    return Source(
        spec, assets, dict(hands), joints, velocity, posture, at_rest, held, tuple(changes)
    )


def _home(
    model: mujoco.MjModel,
    joints: Sequence[str],
    hands: Mapping[str, str],
    given: Mapping[str, float],
    others: Mapping[str, float],
) -> np.ndarray:
    """Return the home posture (n,), given or found, that the motors hold."""
    torque = motor_limits(model, joints)
    if len(given) < len(joints):
        posture = find_home(model, joints, hands, torque, {**others, **given})
    else:
        posture = np.array([given[joint] for joint in joints])
    check_holds(model, joints, torque, {**others, **dict(zip(joints, posture, strict=True))})
    return posture
