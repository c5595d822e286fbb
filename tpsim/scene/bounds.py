"""How large a robot is: the box around its shapes at home."""

import mujoco
import numpy as np

from tpsim.robot.home import put
from tpsim.robot.robot import Robot

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def box(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner (3,), (3,) [m] around what is drawn of a robot at home."""
    model = robot.model
    data = mujoco.MjData(model)
    put(model, data.qpos, robot.description.fixed)
    data.qpos[robot.simulated.qpos] = robot.home
    mujoco.mj_kinematics(model, data)
    points = [robot.at_home.pose(site).position for site in robot.hands.values()]
    for geom in range(model.ngeom):
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_PLANE:
            centre, half = np.split(model.geom_aabb[geom], 2)
            R = data.geom_xmat[geom].reshape(3, 3)
            points.extend(data.geom_xpos[geom] + (centre + _CORNERS * half) @ R.T)
    cloud = np.array(points)
    return cloud.min(0), cloud.max(0)
