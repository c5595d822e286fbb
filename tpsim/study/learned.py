"""What was learned, in numbers: where the teacher was precise, and what matters of it."""

import numpy as np

from tpsim.study.report import Section
from tpsim.task.task import Models, Task

TEXT = (
    "Standard deviation of the demonstrations along every dimension of every candidate frame, "
    "beside that of free movement: how much hands and joints moved at large, or how a view "
    "varies when what it is made of is exchanged between demonstrations. A dimension matters "
    "where the first is so much smaller that it is more probable to be meant than not. Only there "
    "is the robot stiff, in proportion to the precision; how fast the most precise direction is "
    "follows from the delay of the control loop, and what a person feels in free directions is a "
    "friction that is set by hand."
)


def deviations(task: Task, models: Models) -> dict[str, dict[str, dict[str, float]]]:
    """Standard deviation of every dimension of every view of every behaviour, in its own unit.

    It is the mean over the components, weighted by their priors.
    """
    found: dict[str, dict[str, dict[str, float]]] = {}
    for row in rows(task, models):
        frames = found.setdefault(str(row["behaviour"]), {})
        frames.setdefault(str(row["frame"]), {})[str(row["dimension"])] = float(
            str(row["deviation"])
        )
    return found


def rows(task: Task, models: Models) -> list[dict[str, object]]:
    """One row for every dimension of every view of every behaviour.

    ``deviation`` is the mean over components, weighted by their priors; ``free`` that of free
    movement, and ``matters`` the share of components in which the dimension is not free, where
    that was looked at.
    """
    robot, found = task.stage.robot, []
    for name, behaviour in task.behaviours().items():
        model = models[name]
        for j, (view, quantity) in enumerate(behaviour.views.items()):
            labels = quantity.labels(robot)
            variance = np.einsum("k,kii->i", model.priors, model.frames[j].covariance)
            # A model of time and view has its inputs first.
            deviation = np.sqrt(variance[-len(labels) :])
            row: dict[str, object]
            for i, label in enumerate(labels):
                row = {"behaviour": name, "frame": view, "dimension": label}
                row["deviation"] = float(deviation[i])
                if model.relevance:
                    one = model.relevance[j]
                    # A dimension counts if the directions that matter have a part in it.
                    part = np.einsum("kii->ki", one.precision)[:, i] * one.free[i, i] > 1.0
                    row["free movement"] = float(np.sqrt(one.free[i, i]))
                    row["matters"] = "yes" if model.priors @ part > 0.5 else "no"
                found.append(row)
    return found


def section(task: Task, models: Models) -> Section:
    """Table of the report: what the teacher cared about, and what not."""
    return Section("What was learned", TEXT, table=rows(task, models))
