"""From a learned task to the recipe of its controller; on the robot's computer nobody needs it."""

import numpy as np

from tpsim.deploy.recipes import Recipe, recipe_of
from tpsim.deploy.values import taken_apart
from tpsim.errors import ArgumentError
from tpsim.task.task import Models, Situation, Task, controller_of, draw_situation


def recipe_for(task: Task, models: Models, situation: Situation | None = None) -> Recipe:
    """What the controller of a task is made from, in every situation or in one.

    A controller is made in two situations, in which it must turn out the same, except that it may
    hold the start posture: that is filled in where the robot starts.

    Raises
    ------
    ArgumentError
        If the controller is not one of tpsim's, or depends on the situation.
    """
    situations = [situation] if situation else [draw_situation(task, 0, i) for i in (0, 1)]
    first, *others = (_recipe(task, models, each) for each in situations)
    for other in others:
        if field := _difference(first, other):
            raise ArgumentError(
                f"the controller of task '{task.name}' depends on the situation ({field}); give "
                "the one that the policy is for: Policy(task, models, situation)"
            )
    return first


def _recipe(task: Task, models: Models, situation: Situation) -> Recipe:
    controller = controller_of(task, models, situation)
    recipe = recipe_of(controller, task.stage.timestep)
    return recipe.free_of(np.array(situation.start))


def _difference(one: Recipe, other: Recipe) -> str:
    """Name of a part in which two recipes differ; empty if there is none."""
    if type(one) is not type(other):
        return "its kind"
    for name, value in vars(one).items():
        parts: list[tuple[object, dict[str, np.ndarray]]] = []
        for each in (value, getattr(other, name)):
            arrays: dict[str, np.ndarray] = {}
            parts.append((taken_apart(each, arrays), arrays))
        (plain, arrays), (plain_too, arrays_too) = parts
        same = plain == plain_too and all(
            np.array_equal(array, arrays_too[key]) for key, array in arrays.items()
        )
        if not same:
            return name
    return ""
