"""Whether a task fits its world: looked at before anything long begins."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

import numpy as np

from tpsim.errors import ArgumentError, TpsimError
from tpsim.robot.objects import Objects
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.task.task import Task

T = TypeVar("T")


def check(task: Task) -> None:
    """Look at every view, goal and site of a task once, in its world at home.

    Raises
    ------
    SimulationError
        If one asks for a site, a joint or an object that is not there; the message says which.
    ArgumentError
        If the task has no behaviours, or something in it is not what it must be.
    """
    state = _at_home(task)
    behaviours = task.behaviours()
    _check_mapping(task, "behaviours", behaviours)
    for name, behaviour in behaviours.items():
        _check_mapping(task, f"behaviour '{name}', views", behaviour.views)
        for title, view in behaviour.views.items():
            _look(f"view '{title}' of behaviour '{name}'", view, state)
        for title, goal in behaviour.goals.items():
            _look(f"goal '{title}' of behaviour '{name}'", goal.view, state)
    for name, goal in task.goals().items():
        _look(f"goal '{name}'", goal.view, state)
    for name, site in task.sites().items():
        _telling(f"recorded site '{name}'", partial(state.pose, site))


def look(task: Task, what: str, view: object) -> None:
    """Look at one more view in the task's world at home; ``what`` names it in errors."""
    _look(what, view, _at_home(task))


def _at_home(task: Task) -> State:
    """The robot at home among the objects where the scene has them."""
    world = task.stage
    simulation = world.simulation()
    data = simulation.data
    objects = Objects(simulation.objects, data.mocap_pos.copy(), data.mocap_quat.copy())
    simulation.begin()
    return world.robot.at(world.robot.home, objects=simulation.see(objects))


def _check_mapping(task: Task, what: str, found: object) -> None:
    if not isinstance(found, Mapping) or not found:
        raise ArgumentError(
            f"task '{task.name}', {what}: {type(found).__name__} of "
            f"{len(found) if hasattr(found, '__len__') else 'no'} entries was given; give a "
            "mapping of at least one, by name"
        )


def _look(what: str, view: object, state: State) -> None:
    if not isinstance(view, View):
        hint = "; say which part, such as .pose or .position" if hasattr(view, "pose") else ""
        raise ArgumentError(f"{what} is {view!r}, which is no view{hint}")
    seen = _telling(what, lambda: view(state))
    manifold = _telling(what, lambda: view.manifold(state.robot))
    expected = (manifold.width,), (manifold.dim, state.robot.n)
    if (np.shape(seen.value), np.shape(seen.jacobian)) != expected:
        raise ArgumentError(
            f"{what} has a value of shape {np.shape(seen.value)} and a Jacobian of shape "
            f"{np.shape(seen.jacobian)}; on {manifold} give {expected[0]} and {expected[1]}"
        )


def _telling(what: str, work: Callable[[], T]) -> T:
    try:
        return work()
    except TpsimError as error:
        raise type(error)(f"{what}: {error}") from None
