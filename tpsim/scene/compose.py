"""Worlds put together: a robot, what it holds, objects around it, floor, light and cameras."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from tpsim.border import Point, Positive, border, checked
from tpsim.errors import SimulationError, one_line
from tpsim.robot.robot import Robot
from tpsim.scene.bounds import box
from tpsim.scene.camera import Camera
from tpsim.scene.framing import framed
from tpsim.scene.parts import camera as add_camera
from tpsim.scene.parts import hold, light, place
from tpsim.world.grasp import Grasp, write_grasps
from tpsim.world.world import World

PAINTS = ((0.10, 0.33, 0.40), (0.72, 0.42, 0.08), (0.24, 0.42, 0.20))
"""Colours of the objects: teal, ochre, moss."""


@dataclass(frozen=True)
class Held:
    """Something that a hand holds rigidly; the controller's model knows its mass.

    Parameters
    ----------
    model : str
        A model of tpsim (``"cup"``, ``"sugar"``, ``"beam"``), an MJCF file, or MJCF text.
    site : str
        Site of the robot that holds it.
    position : (3,)
        Origin of the model in the site [m].
    axes : two of (3,)
        The model's x and y axes in the site.
    """

    model: str
    site: str
    position: Point = (0.0, 0.0, 0.0)
    axes: tuple[Point, Point] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Placed:
    """Something that stands in the world; a mocap body can be moved by situations.

    Parameters
    ----------
    model : str
        A model of tpsim (``"marker"``, ``"dock"``, ``"table"``), an MJCF file, or MJCF text.
    position : (3,)
        [m]
    paint : (3,), optional
        Red, green, blue of what the model paints.
    size : float
        Factor on the model, whose shapes are then primitive ones.
    solid : bool
        Whether other things touch it, where its model says so; else they pass through it.
    """

    model: str
    position: Point = (0.0, 0.0, 0.0)
    paint: Point | None = None
    size: Positive = 1.0
    solid: bool = True

    def __post_init__(self) -> None:
        checked(self)


@border
def world(
    robot: Robot,
    *,
    objects: Mapping[str, str | Placed] | None = None,
    held: Mapping[str, Held] | None = None,
    taken: Mapping[str, Grasp] | None = None,
    floor: float | None = None,
    cameras: Mapping[str, Camera] | None = None,
) -> World:
    """World of a robot with objects around it.

    Parameters
    ----------
    robot : Robot
    objects : mapping of str to str or Placed, optional
        Things in the world by name; the name of a model is enough for what situations move.
    held : mapping of str to Held, optional
        Things in the robot's hands by name. The name is also that of a site of the robot.
    taken : mapping of str to Grasp, optional
        Things that hands take and let go, by name.
    floor : float, optional
        Height of the floor [m]; the lowest point of the robot by default.
    cameras : mapping of str to Camera, optional
        The film takes ``"hero"``; without one it is placed by the robot's size.

    Raises
    ------
    SimulationError
        If there is no such model or site, or the scene does not compile.
    """
    spec = robot.source.spec.copy()
    centre, extent, lowest = _bounds(robot)
    light(spec, lowest if floor is None else floor, tuple(centre), extent)
    shown = dict(cameras or {})
    if "hero" not in shown and spec.camera("hero") is None:
        away = centre + extent * np.array([1.5, 0.95, 0.55])
        corners = np.array(list(product(*zip(*box(robot), strict=True))))
        shown["hero"] = framed(Camera(tuple(away), tuple(centre)), corners, 0.0, filled=True)
    try:
        _furnish(spec, robot, objects or {}, held or {}, shown)
        _add_taken(spec, taken or {})
    except ValueError as error:
        reason = one_line(error)
        raise SimulationError(f"the scene cannot be put together: {reason}") from None
    return World.compose(robot, spec)


def _furnish(
    spec: mujoco.MjSpec,
    robot: Robot,
    objects: Mapping[str, str | Placed],
    held: Mapping[str, Held],
    cameras: Mapping[str, Camera],
) -> None:
    for k, (name, thing) in enumerate(objects.items()):
        placed = Placed(thing) if isinstance(thing, str) else thing
        paint = placed.paint or PAINTS[k % len(PAINTS)]
        place(spec, placed.model, name, placed.position, paint, placed.size, placed.solid)
    turned = {robot.model.site(k).name: robot.model.site_quat[k] for k in range(robot.model.nsite)}
    for name, item in held.items():
        at = turned.get(item.site)
        hold(spec, item.model, name, item.site, item.position, item.axes, at)
    for name, view in cameras.items():
        add_camera(spec, name, view.position, view.target, view.fovy)


def _add_taken(spec: mujoco.MjSpec, taken: Mapping[str, Grasp]) -> None:
    for name, grasp in taken.items():
        place(spec, grasp.model, name, (0.0, 0.0, 0.0))
    if taken:
        write_grasps(spec, taken)


def _bounds(robot: Robot) -> tuple[np.ndarray, float, float]:
    """Middle (3,), size and lowest point of the robot at home [m], from its bodies and sites."""
    points: Sequence[np.ndarray] = [robot.at_home.pose(site).position for site in robot.sites] or [
        np.zeros(3)
    ]
    cloud = np.array(points)
    middle = (cloud.min(0) + cloud.max(0)) / 2
    extent = float(robot.model.stat.extent)
    return middle, max(extent, 0.3), float(min(cloud[:, 2].min(), 0.0)) - 0.06
