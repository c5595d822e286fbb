"""What was learned, as shapes in the scene and as numbers of how much each frame matters."""

import numpy as np

from tpsim.film.marks import Ellipsoid
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.robot.views.sites import Site, SiteView
from tpsim.robot.views.view import View
from tpsim.task.task import Models, Task

LARGEST = 0.5
"""Semi-axis [m] that is drawn, at most: what is free fills the room."""


def ellipsoids(task: Task, models: Models, state: State) -> dict[str, list[Ellipsoid]]:
    """Components as every frame of positions sees them, where it is now, one deviation large.

    Parameters
    ----------
    task : Task
    models : mapping of str to TPGMM
    state : State
        Where hands and objects are that frames are seen from.

    Returns
    -------
    dict
        By ``"behaviour: frame"``.
    """
    found = {}
    for name, behaviour in task.behaviours().items():
        for (label, view), gaussian in zip(
            behaviour.views.items(), models[name].frames, strict=True
        ):
            place = _base(view, state)
            if place is None:
                continue
            # A model of time and view has its inputs first.
            first = gaussian.dim - len(view.labels(task.stage.robot))
            shapes = []
            for mean, covariance in zip(gaussian.mean, gaussian.covariance, strict=True):
                rows = slice(first, first + 3)
                values, vectors = np.linalg.eigh(covariance[rows, rows])
                size = np.clip(np.sqrt(np.maximum(values, 0.0)), 0.002, LARGEST)
                centre = place.position + place.rotation @ mean[rows]
                shapes.append(Ellipsoid(centre, place.rotation @ vectors, size))
            found[f"{name}: {label}"] = shapes
    return found


def _base(view: View, state: State) -> Pose | None:
    """From where a view of a position is seen; None of a view of something else."""
    if not isinstance(view, SiteView) or view.part not in ("position", "pose"):
        return None
    if view.base is None:
        return Pose(np.eye(3), np.zeros(3))
    if isinstance(view.base, Site):
        return state.pose(view.base.name)
    return state.objects[view.base.name].pose


def weights(task: Task, models: Models) -> dict[str, np.ndarray]:
    """How much every frame matters in each component (K,), 0 to 1.

    The share of its directions in which the demonstrations are more precise than free movement;
    of models for which that was not looked at, the precision beside that of the most precise frame
    of the component, by the means of their logarithms of variances.
    """
    found = {}
    for name, behaviour in task.behaviours().items():
        model = models[name]
        if model.relevance:
            shares = [part.matters.mean(axis=1) for part in model.relevance]
            shares = [
                s * part.precision.any(axis=(1, 2))
                for s, part in zip(shares, model.relevance, strict=True)
            ]
        else:
            logs = np.array(
                [
                    -np.linalg.slogdet(frame.covariance)[1] / (2 * frame.dim)
                    for frame in model.frames
                ]
            )
            shares = list(np.exp(logs - logs.max(axis=0)))
        for label, share in zip(behaviour.views, shares, strict=True):
            found[f"{name}: {label}"] = np.asarray(share, float)
    return found
