"""A policy in a folder: ``policy.json``, ``arrays.npz``, and the scene it was learned in.

The scene and its meshes open in MuJoCo as they are; the policy itself does not read them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np

from tpsim.deploy.recipes import (
    FixedRecipe,
    HorizonRecipe,
    InterventionRecipe,
    PursuitRecipe,
    Recipe,
    TimedRecipe,
    WrittenSkill,
)
from tpsim.deploy.robot_file import RobotFile
from tpsim.deploy.sensed import objects_in
from tpsim.deploy.values import Reader, taken_apart
from tpsim.errors import ArgumentError, RecordingError, TpsimError, one_line
from tpsim.gaussian import Gaussian
from tpsim.learning.free_movement import Relevance
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.orientations import Rotations
from tpsim.manifold.spaces import Circle, Euclidean
from tpsim.manifold.sphere import Sphere
from tpsim.npz import read_members, write_members
from tpsim.pose import Pose
from tpsim.robot.indices import Chain
from tpsim.robot.robot import Robot
from tpsim.robot.views.direction import Bearing, Direction
from tpsim.robot.views.joints import Joints, Spare
from tpsim.robot.views.sites import Object, Site, SiteView
from tpsim.robot.views.view import Beneath, Offset, Part, View
from tpsim.study.files import limits
from tpsim.study.files.checked import from_json, to_json
from tpsim.study.files.inside import checksum, read_inside, read_text_inside
from tpsim.whole import check_free, whole_folder, write_bytes, write_text

if TYPE_CHECKING:
    from tpsim.world.world import World

POLICY, ARRAYS, SCENE = "policy.json", "arrays.npz", "scene.xml"

SCHEMA = 5
"""Of ``policy.json``."""

_MOST = 2**30
"""Bytes of a file."""


@dataclass(frozen=True, eq=False)
class Content:
    """What a policy is, besides its robot.

    Parameters
    ----------
    task : str
        Name of the task.
    period : float
        Time [s] between two commands in simulation.
    recipe : Recipe
    """

    task: str
    period: float
    recipe: Recipe

    def __post_init__(self) -> None:
        if not 0 < self.period < 1:
            raise ArgumentError(f"period is {self.period} s; from above 0 to below 1")


@dataclass(frozen=True, eq=False)
class _Whole:
    robot: RobotFile
    content: Content


_PARTS = (
    *(_Whole, Content, RobotFile, WrittenSkill, Gaussian, Relevance, SemiMarkovChain),
    *(RiemannianGaussian, Manifold, Euclidean, Circle, Sphere, Rotations),
    *(Site, Object, Chain),
)
_RECIPES = (InterventionRecipe, PursuitRecipe, TimedRecipe, HorizonRecipe, FixedRecipe)
_VIEWS = (SiteView, Direction, Bearing, Joints, Spare, Part, Offset, Beneath)


def write(folder: Path, content: Content, robot: Robot, world: "World") -> Path:
    """Write a policy to a new folder, whole or not at all.

    Raises
    ------
    RecordingError
        If the folder holds something.
    """
    check_free(folder)
    arrays: dict = {}
    values = taken_apart(_Whole(RobotFile.of(robot.mechanism), content), arrays)
    with whole_folder(folder) as new:
        path = write_members(new / ARRAYS, arrays)
        about = {"schema": SCHEMA, "arrays": checksum(path.read_bytes()), "policy": values}
        write_text(new / POLICY, to_json(about, indent=1))
        write_text(new / SCENE, world.xml)
        for name, asset in world.assets.items():
            write_bytes(new / name, asset)
    return folder


def read(folder: Path, views: Sequence[type[View]] = ()) -> tuple[Content, Robot]:
    """Read a policy and its robot; the scene is for people and simulators alone.

    Raises
    ------
    RecordingError
        If the folder holds no policy, or a damaged one.
    """
    where = folder / POLICY
    if not where.is_file():
        raise RecordingError(f"{folder} holds no policy; give a folder that tpsim export wrote")
    about = from_json(read_text_inside(folder, POLICY, limits.TEXT), dict, where)
    if about.get("schema") != SCHEMA:
        raise RecordingError(f"{where} is of schema {about.get('schema')}; this is {SCHEMA}")
    if checksum(read_inside(folder, ARRAYS, _MOST)) != about.get("arrays"):
        raise RecordingError(f"{folder / ARRAYS} is damaged or of another policy; export it again")
    kinds = {kind.__name__: kind for kind in (*_PARTS, *_RECIPES, *_VIEWS, *views)}
    reader = Reader(kinds, read_members(folder / ARRAYS), where)
    whole = cast(_Whole, reader.read(about.get("policy"), _Whole))
    try:
        robot = Robot(whole.robot.mechanism())
        _check(whole.content, robot)
    # Pinocchio raises RuntimeError for what is no inertia.
    except (TpsimError, ValueError, TypeError, LookupError, RuntimeError) as error:
        reason = one_line(error, 300)
        raise RecordingError(f"{where} is damaged: it does not fit together ({reason})") from None
    return whole.content, robot


def _check(content: Content, robot: Robot) -> None:
    """Make the controller, and look through every view: sites, joints and sizes must agree."""
    recipe = content.recipe
    recipe.controller(robot, robot.home)
    ahead = Pose(np.eye(3), np.array([0.5, 0.1, 0.2]))
    state = robot.at(robot.home, objects=dict.fromkeys(objects_in(recipe), ahead))
    with np.errstate(all="ignore"):
        if not (np.isfinite(state.mass).all() and np.isfinite(state.bias).all()):
            raise ArgumentError("the robot's inertia or gravity is no number")
    for view, size in recipe.seen():
        if (found := view(state).value.size) != size:
            raise ArgumentError(f"a model of {size} dimensions has a view of {found}")
