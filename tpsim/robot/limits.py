"""Limits as a user gives them: one number, numbers by joint name, or one per joint."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from tpsim.border import read
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.robot.indices import matched

Limit = float | Mapping[str, float] | Sequence[float] | np.ndarray | None
"""``None`` for what the file says, a number for all joints, numbers by joint name or regular
expression (names win, then the first expression that matches), or one number per joint."""


def limits(given: Limit, joints: Sequence[str], argument: str) -> np.ndarray:
    """Return the given limit of every joint (n,), NaN where nothing is given.

    Parameters
    ----------
    given : number, mapping, sequence or None
        See :data:`Limit`.
    joints : sequence of str
        The arm joints, n.
    argument : str
        Name of the argument, for messages.

    Raises
    ------
    ArgumentError
        If a limit is not a positive number, a name matches no joint, or a sequence is not (n,).
    """
    if given is None:
        return np.full(len(joints), np.nan)
    if isinstance(given, Mapping):
        values = _by_name(given, joints, argument)
    else:
        values = _numbers(given, argument)
        if values.ndim == 0:
            values = np.full(len(joints), values)
    if values.shape != (len(joints),):
        raise ArgumentError(
            f"{argument} has shape {values.shape}, but there are {len(joints)} arm joints: "
            f"{', '.join(joints)}"
        )
    if not_positive := [j for j, v in zip(joints, values, strict=True) if v <= 0]:
        raise ArgumentError(f"{argument} of {', '.join(not_positive)} must be positive")
    return values


def velocity_limits(given: Limit, stated: Mapping[str, float], joints: Sequence[str]) -> np.ndarray:
    """Return the velocity limits (n,): given, else stated by the file, else infinite."""
    values = limits(given, joints, "velocity_limit")
    by_file = [stated.get(joint, np.inf) for joint in joints]
    return np.where(np.isnan(values), by_file, values)


def motor_limits(model: mujoco.MjModel, joints: Sequence[str]) -> np.ndarray:
    """Return the torque limits (n,) of joints that have one motor each."""
    limit = {
        model.joint(int(model.actuator_trnid[a, 0])).name: model.actuator_ctrlrange[a, 1]
        for a in range(model.nu)
        if model.actuator_trntype[a] == mujoco.mjtTrn.mjTRN_JOINT
    }
    return np.array([limit[joint] for joint in joints])


def _numbers(given: object, argument: str) -> np.ndarray:
    """Return given numbers as an array without NaN."""
    try:
        return finite_array(argument, given)
    except ArgumentError:
        raise ArgumentError(
            f"{argument} is {shown(given)}, but must be a finite number, one per arm joint, or a "
            "mapping of joint names to numbers"
        ) from None


def _by_name(given: Mapping[str, float], joints: Sequence[str], argument: str) -> np.ndarray:
    values = np.full(len(joints), np.nan)
    read(argument, given, Mapping[str, object])
    patterns = sorted(given, key=lambda name: name not in joints)
    for pattern in reversed(patterns):
        number = _numbers(given[pattern], f"{argument} of '{pattern}'")
        if number.ndim:
            raise ArgumentError(f"{argument} of '{pattern}' must be one number")
        matches = [matched(pattern, joint, argument) for joint in joints]
        if not any(matches):
            raise ArgumentError(
                f"{argument} names '{pattern}', which is no arm joint; they are {', '.join(joints)}"
            )
        values[matches] = number
    return values
