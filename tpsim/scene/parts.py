"""The parts of a scene, put together by MjSpec: models, what hands hold, floor, light, cameras."""

from collections.abc import Callable, Sequence
from pathlib import Path

import mujoco
import numpy as np

from tpsim.errors import SimulationError
from tpsim.paths import MODELS
from tpsim.scene.camera import upright


def read(model: str, name: str) -> mujoco.MjSpec:
    """Read the model of object ``name``: ``models/<model>.xml`` of tpsim, an MJCF file, or MJCF.

    Raises
    ------
    SimulationError
        If there is no such model; the message names those that exist.
    """
    if model.lstrip().startswith("<"):
        return mujoco.MjSpec.from_string(model)
    path = Path(model) if model.endswith(".xml") else MODELS / f"{model}.xml"
    if not path.is_file():
        known = ", ".join(sorted(p.stem for p in MODELS.glob("*.xml"))) or "none"
        raise SimulationError(
            f"object or held {name!r}: no model {model!r} in {MODELS}: known models are {known}"
        )
    return mujoco.MjSpec.from_file(str(path))


def place(
    spec: mujoco.MjSpec,
    model: str,
    name: str,
    position: Sequence[float],
    paint: Sequence[float] | None = None,
    size: float = 1.0,
    solid: bool = True,
) -> None:
    """Put ``models/<model>.xml`` into the world under ``name``, at ``position (3,)`` m.

    ``paint`` (r, g, b) colours what the model paints; ``size`` is a factor on its shapes; a model
    that is a mocap body can be moved in a simulation; nothing touches what is not ``solid``.
    """
    _attach(spec, model, name, spec.worldbody.add_frame(pos=position), size, solid)
    painted = spec.material(f"{name}_paint")
    if paint is not None and painted is not None:
        painted.rgba = (*paint, 1)


def hold(
    spec: mujoco.MjSpec,
    model: str,
    name: str,
    site: str,
    position: Sequence[float],
    axes: Sequence[Sequence[float]] = ((1, 0, 0), (0, 1, 0)),
    turned: np.ndarray | None = None,
) -> None:
    """Fix a model rigidly at ``site``, under ``name``.

    Parameters
    ----------
    spec : MjSpec
        The scene, changed in place.
    model : str
        As :func:`read` takes it.
    name : str
        Of its body and site in the scene.
    site : str
        A site of the scene.
    position : sequence of 3
        Origin of the model, in coordinates of the site, m.
    axes : two sequences of 3
        The model's x and y axes, in coordinates of the site.
    turned : (4,), optional
        Quaternion of the site in its body, as compiled: files may say it in several ways.

    Raises
    ------
    SimulationError
        If the scene has no such site; the message names those that exist.
    """
    at = _site(spec, site)
    x, y = np.array(axes, float)
    rotation, R = np.stack([x, y, np.cross(x, y)], axis=1), np.eye(3)
    if turned is not None:
        mujoco.mju_quat2Mat(R.reshape(-1), turned)
    frame = at.parent.add_frame(pos=at.pos + R @ position, quat=_quaternion(R @ rotation))
    _attach(spec, model, name, frame)


def light(
    spec: mujoco.MjSpec,
    floor: float,
    centre: Sequence[float] = (0.3, 0.0, 0.0),
    extent: float = 1.6,
) -> None:
    """Add sky, a floor at height ``floor`` m that fades into it, and light with one shadow.

    ``centre`` (3,) and ``extent`` [m] are the middle and the size of what is lit.
    """
    sky = (0.87, 0.895, 0.92)
    spec.stat.extent = extent
    spec.stat.center = centre
    spec.visual.rgba.fog = (*sky, 1)
    spec.visual.map.fogstart = 2.2
    spec.visual.map.fogend = 7
    spec.visual.map.shadowclip = 1.8
    spec.visual.quality.numslices = 24
    spec.visual.quality.numstacks = 10
    spec.visual.quality.numquads = 1
    spec.visual.headlight.ambient = (0.37, 0.37, 0.37)
    spec.visual.headlight.diffuse = (0.22, 0.22, 0.22)
    spec.visual.headlight.specular = (0, 0, 0)
    spec.add_texture(
        name=_free(spec.texture, "sky"),
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=(0.80, 0.84, 0.89),
        rgb2=sky,
        width=128,
        height=128 * 6,
    )
    # A robot's file may bring its own floor.
    if not any(geom.type == mujoco.mjtGeom.mjGEOM_PLANE for geom in spec.geoms):
        material = spec.add_material(
            name=_free(spec.material, "floor"), rgba=(0.9, 0.9, 0.9, 1), specular=0
        )
        spec.worldbody.add_geom(
            name=_free(spec.geom, "floor"),
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            pos=(0, 0, floor),
            size=(12, 12, 0.1),
            material=material.name,
            contype=0,
            conaffinity=0,
        )
    spec.worldbody.add_light(
        name=_free(spec.light, "key"),
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=(1.7, 1.8, 4),
        dir=(-0.35, -0.45, -1),
        diffuse=(0.40, 0.40, 0.39),
        specular=(0.3, 0.3, 0.3),
        castshadow=True,
    )
    spec.worldbody.add_light(
        name=_free(spec.light, "fill"),
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        dir=(-0.6, 0.8, -0.4),
        diffuse=(0.18, 0.18, 0.19),
        specular=(0.1, 0.1, 0.1),
        castshadow=False,
    )


def _free(find: Callable[[str], object], name: str) -> str:
    """A name that is not taken yet in a scene."""
    return name if find(name) is None else f"tpsim_{name}"


def camera(
    spec: mujoco.MjSpec,
    name: str,
    position: Sequence[float],
    target: Sequence[float],
    fovy: float,
) -> None:
    """Add a camera at ``position`` that looks at ``target``, upright, with ``fovy`` degrees."""
    quaternion = _quaternion(upright(np.subtract(position, target)).T)
    spec.worldbody.add_camera(name=name, pos=position, quat=quaternion, fovy=fovy)


def _attach(
    spec: mujoco.MjSpec,
    model: str,
    name: str,
    frame: mujoco.MjsFrame,
    size: float = 1.0,
    solid: bool = True,
) -> None:
    """Attach a model at ``frame``; its body, and what is called as this, is called ``name`` here.

    MjSpec cannot save models attached without a prefix, so all other names get ``<name>_``.
    """
    child = read(model, name)
    (body,) = child.worldbody.bodies
    if size != 1.0:
        for geom in child.geoms:
            geom.pos, geom.size = size * geom.pos, size * geom.size
            geom.fromto = size * geom.fromto
    if not solid:
        for geom in child.geoms:
            geom.contype = geom.conaffinity = 0
    inside = body.name
    spec.attach(child, frame=frame, prefix=f"{name}_")
    for kind in (spec.body, spec.geom, spec.site):
        element = kind(f"{name}_{inside}")
        if element is not None:
            element.name = name


def _site(spec: mujoco.MjSpec, name: str) -> mujoco.MjsSite:
    """Return the site of a scene, or say which ones it has."""
    site = spec.site(name)
    if site is None:
        known = ", ".join(s.name for s in spec.sites)
        raise SimulationError(f"the scene has no site {name!r}: its sites are {known}")
    return site


def _quaternion(rotation: np.ndarray) -> np.ndarray:
    """Return the unit quaternion (w, x, y, z) of a rotation matrix."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, rotation.ravel())
    return quaternion
