"""Objects and things put where a recording has them."""

import mujoco
import numpy as np


def put_object(model: mujoco.MjModel, data: mujoco.MjData, name: str, pose: np.ndarray) -> None:
    """Put an object or a thing where a recording has it: (3,) m, or (7,) with (w, x, y, z)."""
    body = model.body(name)
    if (row := int(body.mocapid[0])) >= 0:
        data.mocap_pos[row] = pose[:3]
        data.mocap_quat[row] = pose[3:] if len(pose) == 7 else data.mocap_quat[row]
    else:
        first = int(model.jnt_qposadr[body.jntadr[0]])
        data.qpos[first : first + len(pose)] = pose
