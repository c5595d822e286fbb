"""A robot that stands still at home: its motors hold it, and its parts do not push each other."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from tpsim.errors import ArgumentError
from tpsim.robot.home import put
from tpsim.robot.reading import compiled


def holding_torque(
    model: mujoco.MjModel, joints: Sequence[str], positions: Mapping[str, float]
) -> np.ndarray:
    """Return the torque (n,) [Nm or N] that keeps joints still, against gravity and springs.

    Parameters
    ----------
    model : MjModel
        The compiled robot.
    joints : sequence of str
        The joints, n.
    positions : mapping of str to float
        Where all joints are, rad or m; those left out are at their reference.
    """
    data = _at(model, positions)
    dofs = [int(model.jnt_dofadr[model.joint(joint).id]) for joint in joints]
    return np.asarray(data.qfrc_bias[dofs] - data.qfrc_passive[dofs])


def check_holds(
    model: mujoco.MjModel,
    joints: Sequence[str],
    torque_limit: np.ndarray,
    positions: Mapping[str, float],
) -> None:
    """Refuse a robot whose motors cannot hold it still.

    Raises
    ------
    ArgumentError
        Names the joints, the torques that they need, and their limits.
    """
    needed = np.abs(holding_torque(model, joints, positions))
    weak = [
        f"{joint} needs {need:.3g} of {limit:g}"
        for joint, need, limit in zip(joints, needed, torque_limit, strict=True)
        if need > limit
    ]
    if weak:
        raise ArgumentError(
            f"the robot cannot hold itself up at home: {', '.join(weak)} Nm (N for slides); pass "
            "a larger torque_limit= or another home="
        )


def exclude_touching(spec: mujoco.MjSpec, positions: Mapping[str, float]) -> list[str]:
    """Exclude contacts between bodies that touch at positions, rad or m; say so."""
    model = compiled(spec)
    data = _at(model, positions)
    pairs = {
        tuple(sorted(model.body(int(model.geom_bodyid[geom])).name for geom in contact))
        for contact in data.contact.geom
    }
    for first, second in sorted(pairs):
        spec.add_exclude(bodyname1=first, bodyname2=second)
    return [
        f"'{first}' and '{second}' touch at home: no contact" for first, second in sorted(pairs)
    ]


def _at(model: mujoco.MjModel, positions: Mapping[str, float]) -> mujoco.MjData:
    data = mujoco.MjData(model)
    put(model, data.qpos, positions)
    mujoco.mj_forward(model, data)
    return data
