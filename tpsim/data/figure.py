"""Draw what was demonstrated and what was learned from it."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, FigureBase

from tpsim.data.labels import POSITION
from tpsim.demonstration import Demonstration
from tpsim.gaussian import Gaussian
from tpsim.study.canvas import INK, PALETTE, to_png

MOST = 8
"""Columns that are drawn over time."""


def draw(
    movements: Sequence[Demonstration],
    retrieved: Sequence[Gaussian],
    labels: Sequence[str],
    frames: Sequence[str],
) -> bytes:
    """Draw paths seen from above, and every column over time, with one standard deviation: a PNG.

    Every situation has its colour: dashed what was demonstrated, full what was retrieved.
    """
    count = min(len(labels), MOST)
    planar = tuple(labels[:2]) == POSITION[:2]
    rows = -(-count // 2)
    figure = Figure(
        figsize=(10.5 if planar else 7.6, max(4.2, 1.5 * rows + 0.6)), layout="constrained"
    )
    FigureCanvasAgg(figure)
    right: FigureBase = figure
    if planar:
        halves = figure.add_gridspec(1, 2, width_ratios=(1, 1.5))
        left, right = figure.add_subfigure(halves[0]), figure.add_subfigure(halves[1])
        _draw_paths(left.subplots(), movements, retrieved, labels, frames)
    axes = np.ravel(right.subplots(rows, min(count, 2), sharex=True, squeeze=False))
    for i, axis in enumerate(axes):
        if i >= count:
            axis.set_visible(False)
            continue
        _draw_column(axis, i, movements, retrieved, labels[i])
        axis.tick_params(labelbottom=i + 2 >= count)
        if i + 2 >= count:
            axis.set_xlabel("time [s]", color=INK)
    right.suptitle(
        "dashed: demonstrated    full: retrieved, with one standard deviation",
        fontsize=9,
        color=INK,
    )
    return to_png(figure)


def _draw_paths(
    axis: Axes,
    movements: Sequence[Demonstration],
    retrieved: Sequence[Gaussian],
    labels: Sequence[str],
    frames: Sequence[str],
) -> None:
    _plain(axis)
    for i, (movement, path) in enumerate(zip(movements, retrieved, strict=True)):
        colour = PALETTE[i % len(PALETTE)]
        axis.plot(*movement.data[:, :2].T, color=colour, lw=1, ls=(0, (3, 2)), alpha=0.7)
        axis.plot(*path.mean[:, :2].T, color=colour, lw=1.8)
        axis.plot(*path.mean[0, :2], "o", color=colour, ms=4)
    size = 0.08 * max(np.ptp(np.vstack([m.data[:, :2] for m in movements]), axis=0).max(), 1e-9)
    for j, name in enumerate(frames):
        for i, movement in enumerate(movements):
            _draw_frame(axis, movement, j, size, name if i == 0 else "")
    axis.set_aspect("equal")
    axis.set_anchor("N")
    axis.set_xlabel(labels[0], color=INK)
    axis.set_ylabel(labels[1], color=INK)
    axis.set_title("seen from above", fontsize=9, color=INK, loc="left")


def _draw_frame(axis: Axes, movement: Demonstration, j: int, size: float, name: str) -> None:
    frame = movement.frames[j]
    frame = frame[0] if frame.shape else frame
    origin = frame.b[:2]
    for direction, colour in zip(frame.A[:2, :2].T, ("#c9506a", "#2a9d76"), strict=True):
        length = np.linalg.norm(direction)
        if length > 0:
            tip = origin + size * direction / length
            axis.plot(*np.transpose([origin, tip]), color=colour, lw=1.6, solid_capstyle="round")
    if name:
        axis.annotate(
            name,
            (origin[0], origin[1]),
            (4, -9),
            textcoords="offset points",
            fontsize=8,
            color=INK,
            zorder=5,
        )


def _draw_column(
    axis: Axes,
    i: int,
    movements: Sequence[Demonstration],
    retrieved: Sequence[Gaussian],
    label: str,
) -> None:
    _plain(axis)
    for n, (movement, path) in enumerate(zip(movements, retrieved, strict=True)):
        colour = PALETTE[n % len(PALETTE)]
        deviation = np.sqrt(path.covariance[:, i, i])
        mean = path.mean[:, i]
        axis.fill_between(
            movement.time, mean - deviation, mean + deviation, color=colour, alpha=0.12, lw=0
        )
        axis.plot(movement.time, movement.data[:, i], color=colour, lw=1, ls=(0, (3, 2)), alpha=0.7)
        axis.plot(movement.time, mean, color=colour, lw=1.6)
    axis.set_ylabel(label, color=INK)
    axis.margins(x=0)
    low, high = axis.get_ylim()
    widest = max(float(np.ptp(m.data, axis=0).max()) for m in movements)
    if high - low < 1e-3 * widest:  # a column that stands still
        axis.set_ylim((low + high - widest) / 2, (low + high + widest) / 2)


def _plain(axis: Axes) -> None:
    axis.spines[["top", "right"]].set_visible(False)
    axis.spines[["left", "bottom"]].set(color=INK, alpha=0.5, linewidth=0.8)
    axis.grid(color=INK, alpha=0.1, lw=0.7)
    axis.tick_params(color=INK, labelcolor=INK, labelsize=8, length=3, width=0.7)
    axis.xaxis.label.set_fontsize(9)
    axis.yaxis.label.set_fontsize(9)
