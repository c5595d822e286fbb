"""How figures look, and how they leave: palette, axes, legend, limit; SVG and PNG.

Matplotlib's objects only: no window, no global state.
"""

import io
from collections.abc import Sequence, Sized

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tpsim.plot import INK as INK
from tpsim.plot import PALETTE as PALETTE

PUSH = "#d9a441"
"""Colour of the time of a push."""


def dash(line: Line2D) -> None:
    """Draw a line as that of a limit."""
    line.set(color=INK, linewidth=1, linestyle=(0, (4, 3)), alpha=0.7)


def to_svg(figure: Figure) -> str:
    """Return a figure as one SVG element whose ink is the text colour of the page around it."""
    file = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": "tpsim"}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    svg = file.getvalue()
    return svg[svg.index("<svg") :].replace(INK, "currentColor").strip()


def to_png(figure: Figure, *, dpi: int = 160) -> bytes:
    """Return a figure as the bytes of a PNG file on white paper."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=dpi, facecolor="white")
    return file.getvalue()


def new_figure(*, height: float, columns: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a figure as wide as a page, ``height`` inches high, and its axes beside each other."""
    figure = Figure(figsize=(7.6, height), layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(figure.subplots(1, columns, sharey=True, squeeze=False)[0])
    for axis in axes:
        axis.set_facecolor("none")
        axis.spines[["top", "right"]].set_visible(False)
        axis.spines[["left", "bottom"]].set(color=INK, alpha=0.5, linewidth=0.8)
        axis.grid(color=INK, alpha=0.1, lw=0.7)
        axis.set_axisbelow(True)
        axis.tick_params(color=INK, labelcolor=INK, labelsize=8, length=3, width=0.7)
        for side in (axis.xaxis, axis.yaxis):
            side.label.set_size(9)
    return figure, axes


def limit_line(axes: Sequence[Axes], limit: float | None) -> None:
    """Draw the limit on axes that share y, and scale them: from zero, with room at the top."""
    drawn = [axis.dataLim.intervaly for axis in axes]
    low, high = np.min(drawn), max(np.max(drawn), limit if limit is not None else -np.inf)
    if low >= 0 and np.isfinite(high) and high > 0:
        axes[0].set_ylim(0, 1.14 * high)
    if limit is not None:
        for axis in axes:
            dash(axis.axhline(limit))
        axes[-1].annotate(
            f" limit\n {limit:g}",
            (1, limit),
            va="center",
            fontsize=7.5,
            color=INK,
            xycoords=axes[-1].get_yaxis_transform(),
        )


def legend(axis: Axes) -> None:
    """Name the labels above the axes, where there are at least two."""
    if len(axis.get_legend_handles_labels()[1]) > 1:
        axis.legend(
            loc="lower left",
            bbox_to_anchor=(0, 1),
            ncols=4,
            frameon=False,
            fontsize=8.5,
            labelcolor=INK,
            borderaxespad=0.2,
            handlelength=1.4,
        )


def colours(labels: Sized) -> list[str]:
    """Return a colour for every label, by its place in the palette."""
    return [PALETTE[i % len(PALETTE)] for i in range(len(labels))]
