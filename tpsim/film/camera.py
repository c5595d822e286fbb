"""Where a film is seen from, and light for scenes that have none."""

from copy import copy

import mujoco

from tpsim.world.world import World

HERO = "hero"
"""Camera that films take where they are not told another."""


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
