"""What was learned, in numbers: where the teacher was precise, and what matters of it."""

from collections.abc import Iterator
from typing import NamedTuple

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


class Row(NamedTuple):
    """One dimension of one view of one behaviour.

    Parameters
    ----------
    behaviour, frame, dimension : str
    deviation : float
        Standard deviation, mean over the components, weighted by their priors, in its own unit.
    free : float, optional
        That of free movement, where it was looked at.
    matters : bool
        Whether the directions that matter have a part in it, in most components.
    """

    behaviour: str
    frame: str
    dimension: str
    deviation: float
    free: float | None = None
    matters: bool = True


def rows(task: Task, models: Models) -> Iterator[Row]:
    """Every dimension of every view of every behaviour."""
    for name, behaviour in task.behaviours().items():
        model = models[name]
        seen = zip(
            behaviour.views.items(),
            model.frames,
            model.relevance or [None] * len(model.frames),
            strict=True,
        )
        for (view, quantity), gaussian, relevance in seen:
            labels = quantity.labels(task.stage.robot)
            variance = np.einsum("k,kii->i", model.priors, gaussian.covariance)
            # A model of time and view has its inputs first.
            deviation = np.sqrt(variance[-len(labels) :]).tolist()
            if relevance is None:
                yield from (Row(name, view, *each) for each in zip(labels, deviation, strict=True))
                continue
            free = np.diagonal(relevance.free)
            part = np.einsum("kii->ki", relevance.precision) * free > 1.0
            about = labels, deviation, np.sqrt(free).tolist(), (model.priors @ part > 0.5).tolist()
            yield from (Row(name, view, *each) for each in zip(*about, strict=True))


def deviations(task: Task, models: Models) -> dict[str, dict[str, dict[str, float]]]:
    """Standard deviation of every dimension of every view of every behaviour, in its own unit."""
    found: dict[str, dict[str, dict[str, float]]] = {}
    for row in rows(task, models):
        frames = found.setdefault(row.behaviour, {})
        frames.setdefault(row.frame, {})[row.dimension] = row.deviation
    return found


def section(task: Task, models: Models) -> Section:
    """Table of the report: what the teacher cared about, and what not."""
    table: list[dict[str, object]] = []
    for row in rows(task, models):
        shown: dict[str, object] = {
            "behaviour": row.behaviour,
            "frame": row.frame,
            "dimension": row.dimension,
            "deviation": row.deviation,
        }
        if row.free is not None:
            shown |= {"free movement": row.free, "matters": "yes" if row.matters else "no"}
        table.append(shown)
    return Section("What was learned", TEXT, table=table)
