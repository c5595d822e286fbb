"""Where a film is seen from, and light for scenes that have none."""

from copy import copy
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from tpsim.world.world import World

if TYPE_CHECKING:
    import viser

HERO = "hero"
"""Camera that films take where they are not told another."""


ROOM = 1.25
"""Distance of a browser's camera, over that of films: panels cover a part of the page."""

SHOWN = 2
"""Group of geoms that are looked at, at most; those that collide are in others."""


def cameras(model: mujoco.MjModel) -> list[str]:
    """Names of the cameras of a scene."""
    return [model.camera(index).name for index in range(model.ncam)]


def viewpoint(model: mujoco.MjModel, name: str = "") -> str | mujoco.MjvCamera:
    """A camera by its name; without one ``hero``, or a free camera that sees the whole scene."""
    if name or HERO in cameras(model):
        return name or HERO
    free = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, free)
    return free


def lit(world: World) -> mujoco.MjModel:
    """The scene of a world, to be drawn: with light and a sky where the file has no lamps."""
    if world.model.nlight:
        return copy(world.model)
    spec = mujoco.MjSpec.from_string(world.xml, assets=dict(world.assets))
    spec.visual.headlight.ambient = [0.45] * 3
    spec.visual.headlight.diffuse = [0.6] * 3
    spec.visual.rgba.fog = [0.86, 0.88, 0.90, 1.0]
    if not any(texture.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX for texture in spec.textures):
        spec.add_texture(
            name="sky of the film",
            type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
            builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
            rgb1=[0.93, 0.94, 0.95],
            rgb2=[0.70, 0.74, 0.78],
            width=256,
            height=1536,
        )
    return spec.compile()


def look(camera: "viser.InitialCameraConfig", world: World) -> None:
    """Look at the robot in a browser: from where films are seen, or from before its hands."""
    model = world.model
    data = mujoco.MjData(model)
    data.qpos[[model.joint(name).qposadr[0] for name in world.description.joints]] = (
        world.robot.home
    )
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    middle = np.mean([data.site(site).xpos for site in world.robot.hands.values()], axis=0)
    if HERO in cameras(model):
        place = data.camera(HERO).xpos
        # From the same side, but with the hands in the middle and some room around them.
        camera.position, camera.look_at = middle + ROOM * (place - middle), middle
        camera.fov = np.radians(model.camera(HERO).fovy[0])
        return
    size = max(float(np.linalg.norm(middle - data.xpos[1])), 0.3)
    camera.look_at = middle
    camera.position = middle + size * np.array([2.2, 1.4, 1.1])
