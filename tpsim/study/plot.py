"""Figures of experiments: scalars over time, bars and strips, for any number of controllers.

All share one palette, in the order in which the labels are given: give the same order to every
figure of a report and a controller keeps its colour.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tpsim.errors import ArgumentError
from tpsim.study.canvas import INK, PUSH, colours, dash, legend, limit_line, new_figure
from tpsim.study.metrics import push_interval
from tpsim.study.record import Record

Scalar = Callable[[Record], np.ndarray]
"""What is drawn over time: a function from a record to (T,)."""


def panels(
    groups: Mapping[str, Sequence[Record]],
    scalar: Scalar,
    *,
    label: str,
    limit: float | None = None,
) -> Figure:
    """Draw a scalar over time, one panel per group: all its trials, their median, the push.

    Parameters
    ----------
    groups : mapping of str to sequence of Record
        Trials under a heading, such as a controller's name.
    scalar : callable
        From a record to (T,).
    label : str
        Name and unit of the scalar, ``"tilt [deg]"``.
    limit : float, optional
        Drawn as a dashed line.
    """
    _some(groups)
    figure, axes = new_figure(columns=len(groups), height=2.5)
    for axis, (heading, records), colour in zip(axes, groups.items(), colours(groups), strict=True):
        curves = [np.asarray(scalar(record)) for record in records]
        for record, curve in zip(records, curves, strict=True):
            axis.plot(record["time"], curve, color=colour, lw=0.7, alpha=_faint(len(records)))
        # A trial that was cut short would cut the median short.
        whole = max(map(len, curves), default=0)
        if len(kept := [curve for curve in curves if len(curve) == whole]) > 2:
            clock = next(record["time"] for record in records if len(record["time"]) == whole)
            axis.plot(clock, np.median(kept, axis=0), color=colour, lw=2.0)
        _shade_push(axis, records)
        axis.set_title(heading, color=INK, fontsize=9.5, loc="left", fontweight="bold")
        axis.set_xlabel("time [s]", color=INK)
    limit_line(axes, limit)
    axes[0].set_ylabel(label, color=INK)
    return figure


def overlay(
    records: Mapping[str, Record], scalar: Scalar, *, label: str, limit: float | None = None
) -> Figure:
    """Draw a scalar over time for several trials in one panel, such as one per controller.

    Parameters are those of :func:`panels`, with one trial under each heading.
    """
    return _curves({name: (one, scalar) for name, one in records.items()}, label, limit)


def signals(
    record: Record, scalars: Mapping[str, Scalar], *, label: str, limit: float | None = None
) -> Figure:
    """Draw several scalars of one trial over time in one panel, such as stiffness along x, y, z.

    Parameters are those of :func:`panels`, with one scalar under each heading.
    """
    return _curves({name: (record, one) for name, one in scalars.items()}, label, limit)


def _curves(named: Mapping[str, tuple[Record, Scalar]], label: str, limit: float | None) -> Figure:
    _some(named)
    figure, (axis,) = new_figure(height=2.7)
    for (name, (record, scalar)), colour in zip(named.items(), colours(named), strict=True):
        axis.plot(record["time"], scalar(record), color=colour, lw=1.8, label=name)
    _shade_push(axis, [record for record, _ in named.values()])
    limit_line([axis], limit)
    axis.set_xlabel("time [s]", color=INK)
    axis.set_ylabel(label, color=INK)
    legend(axis)
    return figure


def paired_bars(
    groups: Mapping[str, Mapping[str, float]], *, label: str, limit: float | None = None
) -> Figure:
    """Draw bars side by side: for every category one bar of each group.

    Parameters
    ----------
    groups : mapping of str to mapping of str to float
        ``groups["stiff"]["+x"]`` is the value of group ``stiff`` in category ``+x``.
    label : str
        Name and unit of the value.
    limit : float, optional
        Drawn as a dashed line.
    """
    _some(groups)
    categories = list(dict.fromkeys(name for values in groups.values() for name in values))
    figure, (axis,) = new_figure(height=2.7)
    width = 0.8 / len(groups)
    for i, ((name, values), colour) in enumerate(zip(groups.items(), colours(groups), strict=True)):
        places = np.arange(len(categories)) + (i - (len(groups) - 1) / 2) * width
        heights = [values.get(category, np.nan) for category in categories]
        bars = axis.bar(places, heights, 0.9 * width, color=colour, label=name)
        if len(categories) * len(groups) <= 24:
            axis.bar_label(bars, fmt="%.3g", color=INK, fontsize=7, padding=1.5)
    axis.set_xticks(range(len(categories)), categories)
    axis.grid(False, axis="x")
    axis.tick_params(axis="x", length=0)
    limit_line([axis], limit)
    axis.set_ylabel(label, color=INK)
    legend(axis)
    return figure


def strips(
    groups: Mapping[str, Sequence[float]], *, label: str, limit: float | None = None
) -> Figure:
    """Draw one dot per trial and a bar at the mean, one row per group.

    Parameters
    ----------
    groups : mapping of str to sequence of float
        Values of all trials under a heading.
    label : str
        Name and unit of the value.
    limit : float, optional
        Drawn as a dashed line.
    """
    _some(groups)
    figure, (axis,) = new_figure(height=0.9 + 0.42 * len(groups))
    for row, (values, colour) in enumerate(zip(groups.values(), colours(groups), strict=True)):
        # Dots of equal value lie beside each other: the golden ratio spreads any number evenly.
        spread = (np.arange(len(values)) * 0.618) % 1 - 0.5
        axis.scatter(values, row + 0.5 * spread, s=13, color=colour, alpha=0.55, lw=0)
        axis.plot([np.mean(values)] * 2, [row - 0.36, row + 0.36], color=colour, lw=2.2)
    axis.set_yticks(range(len(groups)), groups)
    axis.set_ylim(len(groups) - 0.45, -0.55)
    axis.grid(False, axis="y")
    axis.tick_params(axis="y", length=0)
    axis.set_xlim(left=0)
    if limit is not None:
        dash(axis.axvline(limit))
        axis.annotate(
            f"limit {limit:g}",
            (limit, 1),
            ha="center",
            va="bottom",
            fontsize=7.5,
            color=INK,
            xycoords=axis.get_xaxis_transform(),
        )
    axis.set_xlabel(label, color=INK)
    return figure


def _shade_push(axis: Axes, records: Sequence[Record]) -> None:
    axis.margins(x=0)
    pushes = [push for record in records if (push := push_interval(record.trial))]
    if not pushes:
        return
    start, end = min(p[0] for p in pushes), max(p[1] for p in pushes)
    axis.axvspan(start, end, color=PUSH, alpha=0.16, lw=0)
    axis.text(
        (start + end) / 2,
        0.97,
        "push",
        transform=axis.get_xaxis_transform(),
        color=PUSH,
        ha="center",
        va="top",
        fontsize=8,
        fontweight="bold",
    )


def _faint(count: int) -> float:
    return max(0.18, min(0.8, 8 / max(count, 1)))


def _some(groups: Mapping[str, object]) -> None:
    if not groups:
        raise ArgumentError("nothing to draw: give at least one label with its values")
