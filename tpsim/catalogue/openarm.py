"""OpenArm v2 of the package ``openarm-mujoco``: two arms of seven joints on a pedestal."""

import mujoco

from tpsim.catalogue.arms import Arms, Side
from tpsim.robot.gripper import Gripper

_PEDESTAL = 0.698
"""Height of the pedestal, on top of which the arms are [m]."""


def openarm() -> Arms:
    """OpenArm on its pedestal; the origin is between its shoulders."""
    from openarm_mujoco.v2 import asset_path

    spec = mujoco.MjSpec.from_file(asset_path("openarm_bimanual.xml"))
    mesh = spec.add_mesh(name="pedestal", file="visual/body/body_link0.stl")
    mesh.scale = (0.001, 0.001, 0.001)
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="pedestal",
        material="matte_black",
        pos=(0, 0, -_PEDESTAL),
        contype=0,
        conaffinity=0,
        group=2,
    )
    sides: tuple[Side, ...] = ("left", "right")
    return Arms(
        spec,
        # Between the fingertips; they open along y and reach along -z.
        {
            side: Gripper(f"{side}_ee_control_point", (-0.0127, 0, -0.155), (0, 0, -1), (0, 1, 0))
            for side in sides
        },
        {side: f"openarm_{side}_link4" for side in sides},
    )
