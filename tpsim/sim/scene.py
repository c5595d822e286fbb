"""Scenes: robots, objects and light, composed from the files of ``models/`` by MjSpec.

Every scene is a text of MJCF. The model that is simulated is compiled from that very text, so the
``scene.xml`` of a run folder repeats it bit for bit.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from tpsim.errors import SimulationError
from tpsim.paths import MODELS

FLOOR = -0.93
"""Height of the floor below Baxter's torso frame, m."""

HOME = (
    *(0.77643, 0.48409, -0.91141, 2.06775, -0.10938, 0.33157, -0.67192),
    *(0.49732, -0.90217, 1.1919, 1.40747, -0.61722, 1.47197, 0.00951),
)
"""Both arms before the chest, cup level, sugar 8 cm above the middle of its rim, rad."""


def cup_and_sugar() -> str:
    """Return Baxter at its table, a cup in the left gripper, a sugar cube in the right one.

    The cup is held by its handle: its axis is the gripper's x, its handle points along -z of the
    gripper. Sites ``cup`` (middle of the opening, z along the axis) and ``sugar`` (centre) are the
    hands of the task. The keyframe ``home`` is ``HOME``.

    Returns
    -------
    str
        MJCF text.
    """
    spec = read("baxter")
    _stage(spec, FLOOR)
    attach(spec, "table", position=(0.7, 0, -0.22))
    hold(spec, "cup", "left_gripper", position=(0, 0, 0.056), axes=((0, 0, 1), (0, -1, 0)))
    hold(spec, "sugar", "right_gripper", position=(0, 0, 0.006))
    _camera(spec, "hero", position=(2.4, 1.3, 0.75), target=(0.32, 0.05, 0.2), fovy=30)
    _camera(spec, "hands", position=(1.35, 0.6, 0.4), target=(0.55, 0.06, 0.19), fovy=32)
    _camera(spec, "side", position=(0.9, 2.9, 0.45), target=(0.35, 0, 0.08), fovy=32)
    spec.add_key(name="home", qpos=HOME)
    return text(spec)


def read(name: str) -> mujoco.MjSpec:
    """Read ``models/<name>.xml``.

    Raises
    ------
    SimulationError
        If there is no such model; the message names those that exist.
    """
    path = MODELS / f"{name}.xml"
    if not path.is_file():
        known = ", ".join(sorted(p.stem for p in MODELS.glob("*.xml"))) or "none"
        raise SimulationError(f"no model {name!r} in {MODELS}: known models are {known}")
    return mujoco.MjSpec.from_file(str(path))


def attach(spec: mujoco.MjSpec, name: str, position: Sequence[float]) -> None:
    """Put model ``name`` into the world at ``position (3,)`` m."""
    _place(spec, name, spec.worldbody.add_frame(pos=position))


def hold(
    spec: mujoco.MjSpec,
    name: str,
    site: str,
    position: Sequence[float],
    axes: Sequence[Sequence[float]] = ((1, 0, 0), (0, 1, 0)),
) -> None:
    """Fix model ``name`` rigidly at ``site``.

    Parameters
    ----------
    spec : MjSpec
        The scene, changed in place.
    name : str
        A model of ``models/``.
    site : str
        A site of the scene.
    position : sequence of 3
        Origin of the model, in coordinates of the site, m.
    axes : two sequences of 3
        The model's x and y axes, in coordinates of the site.

    Raises
    ------
    SimulationError
        If the scene has no such site; the message names those that exist.
    """
    at = _site(spec, site)
    x, y = np.array(axes, float)
    rotation = np.stack([x, y, np.cross(x, y)], axis=1)
    frame = at.parent.add_frame(pos=at.pos + np.asarray(position), quat=_quaternion(rotation))
    _place(spec, name, frame)


def text(spec: mujoco.MjSpec) -> str:
    """Return the MJCF text of a scene that compiles."""
    spec.compile()
    return spec.to_xml()


def _stage(spec: mujoco.MjSpec, floor: float) -> None:
    """Add sky, a floor at height ``floor`` m that fades into it, and light with one shadow."""
    sky = (0.87, 0.895, 0.92)
    spec.stat.extent = 1.6
    spec.stat.center = (0.3, 0, 0)
    spec.visual.rgba.fog = (*sky, 1)
    spec.visual.map.fogstart = 2.2
    spec.visual.map.fogend = 7
    spec.visual.map.shadowclip = 1.4
    spec.visual.quality.numslices = 28
    spec.visual.quality.numstacks = 10
    spec.visual.quality.numquads = 1
    spec.visual.headlight.ambient = (0.37, 0.37, 0.37)
    spec.visual.headlight.diffuse = (0.22, 0.22, 0.22)
    spec.visual.headlight.specular = (0, 0, 0)
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.80, 0.84, 0.89),
        rgb2=sky,
        width=128,
        height=128 * 6,
    )
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=(0, 0, floor),
        size=(12, 12, 0.1),
        rgba=(0.95, 0.95, 0.95, 1),
        contype=0,
        conaffinity=0,
    )
    spec.worldbody.add_light(
        name="key",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=(1.5, 1.0, floor + 4),
        dir=(-0.35, -0.45, -1),
        diffuse=(0.40, 0.40, 0.39),
        specular=(0.3, 0.3, 0.3),
        castshadow=True,
    )
    spec.worldbody.add_light(
        name="fill",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        dir=(-0.6, 0.8, -0.4),
        diffuse=(0.18, 0.18, 0.19),
        specular=(0.1, 0.1, 0.1),
        castshadow=False,
    )


def _camera(
    spec: mujoco.MjSpec,
    name: str,
    position: Sequence[float],
    target: Sequence[float],
    fovy: float,
) -> None:
    """Add a camera at ``position`` that looks at ``target``, upright, with ``fovy`` degrees."""
    backward = np.subtract(position, target)
    right = np.cross((0, 0, 1), backward)
    up = np.cross(backward, right)
    axes = [axis / np.linalg.norm(axis) for axis in (right, up, backward)]
    quaternion = _quaternion(np.stack(axes, axis=1))
    spec.worldbody.add_camera(name=name, pos=position, quat=quaternion, fovy=fovy)


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """Return the unit quaternion (w, x, y, z) of a rotation matrix."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, rotation.ravel())
    return quaternion


def _place(spec: mujoco.MjSpec, name: str, frame: mujoco.MjsFrame) -> None:
    """Attach model ``name`` at ``frame``; what is called ``name`` inside keeps its name.

    MjSpec cannot save models attached without a prefix, so all other names get ``<name>_``.
    """
    spec.attach(read(name), frame=frame, prefix=f"{name}_")
    for kind in (spec.body, spec.geom, spec.site):
        element = kind(f"{name}_{name}")
        if element is not None:
            element.name = name


def _site(spec: mujoco.MjSpec, name: str) -> mujoco.MjsSite:
    """Return the site of a scene, or say which ones it has."""
    site = spec.site(name)
    if site is None:
        known = ", ".join(s.name for s in spec.sites)
        raise SimulationError(f"the scene has no site {name!r}: its sites are {known}")
    return site
