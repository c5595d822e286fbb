"""What every frame saw of demonstrations, when it matters, and small plots of both."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from tpsim.demonstration import Demonstration
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.play.learned import weights
from tpsim.plot.style import INK, PALETTE
from tpsim.task.task import Models, Task, demonstration
from tpsim.task.verbs import Taught

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

Seen = Mapping[str, Sequence[Demonstration]]
"""Demonstrations of every behaviour, as its views see them."""

MOMENTS = 60
"""Points of a curve over a movement."""

POINTS = 120
"""Points of a line, at most."""

DASHES = ("solid", "dash", "dot")
"""One for each behaviour."""

CIRCLE = np.linspace(0, 2 * np.pi, 41)


def look(task: Task, taught: Taught) -> dict[str, list[Demonstration]]:
    """See demonstrations through the views of their behaviours."""
    behaviours = task.behaviours()
    return {
        name: [
            demonstration(task.stage, trial, behaviours[name].views, behaviours[name].cutoff)
            for trial in trials
        ]
        for name, trials in taught.items()
    }


def matters(task: Task, models: Models, seen: Seen) -> dict[str, np.ndarray]:
    """How much every frame matters over the movement (MOMENTS,), 0 to 1.

    The shares of :func:`tpsim.play.learned.weights`, weighted by how probable each component is
    at that moment, Eq. (49); mean over the demonstrations.
    """
    shares, found = weights(task, models), {}
    for name, behaviour in task.behaviours().items():
        if not seen.get(name):
            continue
        active = np.mean([_active(models[name], each) for each in seen[name]], axis=0)
        for view in behaviour.views:
            found[f"{name}: {view}"] = active @ shares[f"{name}: {view}"]
    return found


def _active(model: TPGMM, seen: Demonstration) -> np.ndarray:
    """Probabilities (MOMENTS, K) of the components over one demonstration."""
    rows = np.linspace(0, len(seen.time) - 1, MOMENTS).round().astype(int)
    views = [view[rows] for view in seen.observations]
    if model.dims[0] > views[0].shape[1]:  # a model of time and view has its inputs first
        views = [np.column_stack([seen.time[rows], view]) for view in views]
    return model.responsibilities(views)


def plot_matters(curves: Mapping[str, np.ndarray]) -> "Figure":
    """How much each frame matters, from the beginning to the end of the movement."""
    figure = _figure("share of the movement", "how much it matters")
    behaviours = list(dict.fromkeys(name.partition(":")[0] for name in curves))
    for k, (name, curve) in enumerate(curves.items()):
        dash = DASHES[behaviours.index(name.partition(":")[0]) % len(DASHES)]
        figure.add_scatter(
            x=np.linspace(0, 1, len(curve)).round(3),
            y=curve.round(4),
            name=name,
            line={"color": PALETTE[k % len(PALETTE)], "width": 2, "dash": dash},
        )
    figure.update_yaxes(range=[-0.03, 1.03])
    figure.update_layout(
        showlegend=True, legend={"yref": "container", "y": 0.0, "yanchor": "bottom", "x": 0.0}
    )
    figure.update_layout(margin_b=36 + 17 * len(curves))
    return figure


def plot_seen(
    seen: Sequence[Demonstration],
    frame: int,
    labels: Sequence[str],
    learned: Gaussian | None = None,
) -> "Figure":
    """What one frame saw, in the two dimensions that vary most of those in its first unit.

    Ellipses are the components, of one deviation.

    Parameters
    ----------
    seen : sequence of Demonstration
    frame : int
        Number of the view.
    labels : sequence of str
        Of its dimensions.
    learned : Gaussian (K, d), optional
        The components in this frame.
    """
    paths = [each.observations[frame] for each in seen]
    if len(labels) == 1:
        figure = _figure("time [s]", labels[0])
        for each, path in zip(seen, paths, strict=True):
            _line(figure, each.time, path[:, 0])
        return figure
    same = [k for k, label in enumerate(labels) if _unit(label) == _unit(labels[0])]
    spread = np.concatenate(paths).std(axis=0)
    by_spread = sorted(range(len(labels)), key=lambda k: (k not in same, -spread[k]))
    a, b = sorted(by_spread[:2])
    figure = _figure(labels[a], labels[b])
    for path in paths:
        _line(figure, path[:, a], path[:, b])
    if learned is not None:
        first = learned.dim - len(labels)
        pair = [first + a, first + b]
        for k, (mean, covariance) in enumerate(zip(learned.mean, learned.covariance, strict=True)):
            root = np.linalg.cholesky(covariance[np.ix_(pair, pair)])
            edge = mean[pair] + np.column_stack([np.cos(CIRCLE), np.sin(CIRCLE)]) @ root.T
            figure.add_scatter(
                x=edge[:, 0].round(5),
                y=edge[:, 1].round(5),
                fill="toself",
                hoverinfo="skip",
                line={"color": PALETTE[k % len(PALETTE)], "width": 1},
            )
    return figure


def _unit(label: str) -> str:
    return label.rpartition("[")[2]


def _line(figure: "Figure", x: np.ndarray, y: np.ndarray) -> None:
    every = max(1, len(x) // POINTS)
    figure.add_scatter(
        x=x[::every].round(5),
        y=y[::every].round(5),
        hoverinfo="skip",
        opacity=0.7,
        line={"color": INK, "width": 1},
    )


def _figure(x: str, y: str) -> "Figure":
    from plotly.graph_objects import Figure

    figure = Figure()
    axis = {"showgrid": True, "gridcolor": "#e8e8e6", "zeroline": False, "title_standoff": 4}
    figure.update_layout(
        template="none",
        margin={"l": 48, "r": 8, "t": 8, "b": 36},
        font={"size": 10, "color": INK},
        showlegend=False,
        xaxis={**axis, "title": x},
        yaxis={**axis, "title": y},
    )
    return figure
