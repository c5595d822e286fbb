"""Force limits that a robot's file states, and which of its actuators are motors."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np


def actuator_id(model: mujoco.MjModel, actuator: mujoco.MjsActuator) -> int:
    """Return the number that a model knows an actuator by."""
    return int(model.actuator(actuator.name).id)


def stated_limit(model: mujoco.MjModel, joint: str, drives: Sequence[mujoco.MjsActuator]) -> float:
    """Return the torque limit of a joint by the file; infinite where there is none."""
    bounds = [_force_limit(model, actuator_id(model, a)) for a in drives]
    # Several actuators on one joint are the servo loops of one motor.
    by_actuators = max((b for b in bounds if np.isfinite(b)), default=math.inf)
    return min(by_actuators, joint_limit(model, model.joint(joint).id))


def joint_limit(model: mujoco.MjModel, joint: int) -> float:
    """Return the limit of all actuators together on one joint; infinite without one."""
    if not model.jnt_actfrclimited[joint]:
        return math.inf
    return both_ways(model.jnt_actfrcrange[joint])


def _force_limit(model: mujoco.MjModel, actuator: int) -> float:
    """Return the largest joint torque of one actuator, behind its gear."""
    bound = math.inf
    if model.actuator_forcelimited[actuator]:
        bound = both_ways(model.actuator_forcerange[actuator])
    if model.actuator_ctrllimited[actuator] and is_motor(model, actuator):
        gain = abs(float(model.actuator_gainprm[actuator, 0]))
        bound = min(bound, gain * both_ways(model.actuator_ctrlrange[actuator]))
    return bound * abs(float(model.actuator_gear[actuator, 0]))


def both_ways(interval: np.ndarray) -> float:
    """Return the torque available in both directions; infinite (unknown) if there is none."""
    low, high = map(float, interval)
    return min(-low, high) if low < 0 < high else math.inf


def is_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether an actuator's force is its control times a constant, at once."""
    return bool(
        model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
        and model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_NONE
        and model.actuator_plugin[actuator] < 0
        and model.actuator_delay[actuator] == 0
    )


def is_torque_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Whether an actuator's control is the torque on its joint."""
    one = model.actuator_gainprm[actuator, 0] == 1 and model.actuator_gear[actuator, 0] == 1
    return is_motor(model, actuator) and bool(one)
