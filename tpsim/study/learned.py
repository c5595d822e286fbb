"""What was learned, in numbers: where the teacher was precise, and where not."""

import numpy as np

from tpsim.study.report import Section
from tpsim.task.task import Models, Task

TEXT = (
    "Standard deviation of the demonstrations along every dimension of every candidate "
    "frame. Nothing was set by hand: where the teacher was precise the number is small, and "
    "there the robot is stiff."
)


def deviations(task: Task, models: Models) -> dict[str, dict[str, dict[str, float]]]:
    """Standard deviation of every dimension of every view of every behaviour, in its own unit.

    It is the mean over the components, weighted by their priors.
    """
    robot = task.stage.robot
    found: dict[str, dict[str, dict[str, float]]] = {}
    for name, behaviour in task.behaviours().items():
        model, seen = models[name], {}
        for (view, quantity), gaussian in zip(behaviour.views.items(), model.frames, strict=True):
            variance = np.einsum("k,kii->i", model.priors, gaussian.covariance)
            labels = quantity.labels(robot)
            # A model of time and view has its inputs first.
            deviation = np.sqrt(variance[-len(labels) :])
            seen[view] = dict(zip(labels, map(float, deviation), strict=True))
        found[name] = seen
    return found


def section(task: Task, models: Models) -> Section:
    """Table of the report: what the teacher cared about, and what not."""
    rows = [
        {"behaviour": behaviour, "frame": frame, "dimension": label, "deviation": deviation}
        for behaviour, views in deviations(task, models).items()
        for frame, dimensions in views.items()
        for label, deviation in dimensions.items()
    ]
    return Section("What was learned", TEXT, table=rows)
