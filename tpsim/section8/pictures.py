"""Pictures: the layout of Figs 12 to 14, error against distance, error against demonstrations."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.gaussian import Gaussian
from tpsim.plot import frames as draw_frames
from tpsim.plot import tube
from tpsim.section8.families import Situation
from tpsim.section8.method import Method, Path
from tpsim.section8.results import Results
from tpsim.section8.statistics import Estimate
from tpsim.section8.trial import learn, retrieved
from tpsim.study.canvas import INK, PALETTE, new_figure

CURVES = ("TP-GMM", "TP-GMR", "TP-GMR product", "TP-trajGMM", "TP-ProMP", "DMP", "GPR", "PGMM")
"""Methods whose curves are drawn in colour; the others are faint."""

COLOURS = (*PALETTE, "#4d5b66", "#b0892f")


Column = tuple[Sequence[Demonstration], Situation]
"""What was taught, and where it is asked for."""


def layout(
    methods: Mapping[str, Method], columns: Sequence[Column], titles: Sequence[str]
) -> Figure:
    """Draw a row per method and a column per situation, with covariances (Figs 12 to 14).

    The teacher's own movement is dashed.
    """
    size = (1.9 * len(columns) + 1.1, 1.15 * len(methods) + 0.3)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(len(methods), len(columns), squeeze=False, sharex="col")
    for axes, (name, method) in zip(grid, methods.items(), strict=True):
        learned = {id(taught): learn(method, list(taught)) for taught, _ in columns}
        for axis, (taught, situation) in zip(axes, columns, strict=True):
            retrieve, reason = learned[id(taught)]
            path = None
            if retrieve is not None:
                path, reason = retrieved(retrieve, situation)
            _draw(axis, taught, situation, path, reason)
        axes[0].set_ylabel(name, color=INK, fontsize=8, rotation=0, ha="right", va="center")
    for axis, title in zip(grid[0], titles, strict=True):
        axis.set_title(title, fontsize=8, color=INK)
    return figure


def _draw(
    axis: Axes,
    demonstrations: Sequence[Demonstration],
    situation: Situation,
    path: Path | None,
    reason: str,
) -> None:
    truth = _plane(situation.truth.data)
    taught = [_plane(demonstration.data) for demonstration in demonstrations]
    for line in taught:
        axis.plot(*line.T, color=INK, lw=0.6, alpha=0.3)
    axis.plot(*truth.T, color=INK, lw=0.8, ls=(0, (3, 2)))
    if path is None:
        axis.text(0.5, 0.5, reason[:40], fontsize=5, ha="center", transform=axis.transAxes)
    elif isinstance(path, Gaussian) and path.dim > 1:
        tube(axis, path.marginal([0, 1]), colour=PALETTE[0])
    else:
        x = path.mean if isinstance(path, Gaussian) else np.asarray(path)
        axis.plot(*_plane(x).T, color=PALETTE[0], lw=1.8)
    draw_frames(axis, [f for f in situation.frames if f is not None and f.A.shape == (2, 2)])
    shown = np.vstack([truth, *taught])
    margin = 0.15 * np.ptp(shown)
    low, high = shown.min(0) - margin, shown.max(0) + margin
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xticks=[], yticks=[], aspect="equal")
    axis.spines[:].set_visible(False)


def _plane(x: NDArray) -> NDArray:
    """First two coordinates (T, 2) of a movement, or progress and the only one."""
    return x[:, :2] if x.shape[1] > 1 else np.column_stack([np.linspace(0, 1, len(x)), x])


def against_distance(results: Results) -> Figure:
    """Draw rms over the distance of the situations, with 95 % intervals."""
    family, count = results.headline
    distances = results.plan.distances
    estimates = [results.estimate(family, count, d, "rms") for d in distances]
    xlabel = "spread of the situations, times that of the demonstrations"
    return _curves(results, distances, estimates, xlabel, "rms [m]")


def against_demonstrations(results: Results, distance: float) -> Figure:
    """Draw rms at a distance over the number of demonstrations, with 95 % intervals."""
    family, _ = results.headline
    counts = results.plan.counts
    estimates = [results.estimate(family, count, distance, "rms") for count in counts]
    ylabel = f"rms at {distance:g} times the spread [m]"
    return _curves(results, counts, estimates, "demonstrations", ylabel)


def _curves(
    results: Results, at: Sequence[float], estimates: Sequence[Estimate], xlabel: str, ylabel: str
) -> Figure:
    """Draw the means of all methods, with their intervals, over n places."""
    curves = np.array([[e.mean, e.low, e.high] for e in estimates])
    figure, (axis,) = new_figure(height=3.8)
    coloured = dict(zip((c for c in CURVES if c in results.methods), COLOURS, strict=False))
    for m, name in enumerate(results.methods):
        mean, low, high = curves[:, :, m].T
        if not np.isfinite(mean).any():
            continue
        if name not in coloured:
            axis.plot(at, mean, color=INK, lw=0.7, alpha=0.25)
            continue
        axis.fill_between(at, low, high, color=coloured[name], alpha=0.18, lw=0)
        axis.plot(at, mean, color=coloured[name], lw=1.8, marker="o", ms=3, label=name)
    axis.set(xlabel=xlabel, ylabel=ylabel, xscale="log", yscale="log")
    axis.set_xticks(at, [f"{place:g}" for place in at])
    axis.minorticks_off()
    if axis.get_legend_handles_labels()[1]:
        axis.legend(
            loc="center left", bbox_to_anchor=(1, 0.5), frameon=False, fontsize=8, labelcolor=INK
        )
    return figure


def on_arms(closed: Mapping[str, Results]) -> Figure:
    """Draw how far the hand was from the teacher's path, a panel per arm, with 95 % intervals."""
    names = next(iter(closed.values())).methods
    figure, panels = new_figure(height=0.19 * len(names) + 0.9, columns=len(closed))
    rows = np.arange(len(names))
    for axis, (arm, results) in zip(panels, closed.items(), strict=True):
        family, count = results.headline
        for distance, colour in zip(results.plan.distances, COLOURS, strict=False):
            e = results.estimate(family, count, distance, "rms")
            axis.hlines(rows, e.low, e.high, color=colour, lw=1.6, alpha=0.6)
            axis.plot(e.mean, rows, "o", color=colour, ms=4, label=f"{distance:g} x the spread")
        axis.set(xscale="log", xlabel="rms [mm]", ylim=(len(names) - 0.5, -0.5))
        axis.set_yticks(rows, names, fontsize=7)
        axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.minorticks_off()
        axis.set_title(arm, fontsize=9, color=INK)
        axis.legend(
            loc="lower center",
            bbox_to_anchor=(0.5, 1.03),
            ncols=len(results.plan.distances),
            frameon=False,
            fontsize=7,
            labelcolor=INK,
        )
    return figure
