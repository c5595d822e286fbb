"""One style for all figures: colours, axes, legend, and how a figure becomes a file."""

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import is_color_like, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from numpy.typing import ArrayLike

from tpsim.border import Count, NotNegative, Range, border
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.whole import whole_path

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's colours: told apart with any kind of colour blindness, on light and dark."""

INK = "#1c1e21"
"""Colour of text, axes and demonstrations."""

Kind = Literal["plane", "curve"]
"""``"plane"`` has the same scale on both axes, ``"curve"`` a light grid."""


Panels = Annotated[int, Range(least=1, most=20)]
Opacity = Annotated[float, Range(least=0, most=1)]
Inches = Annotated[float, Range(above=0, most=100)]


class _Drawn:
    """What Matplotlib calls a colour or a marker, checked."""

    def __init__(self, what: str, known: Callable[[object], bool]):
        self.what, self.known = what, known

    def read(self, name: str, value: object) -> object:
        """The word, where Matplotlib knows it."""
        if not isinstance(value, str) or not self.known(value):
            raise ArgumentError(f"{name} is {shown(value)}; give a {self.what} of Matplotlib")
        return value


def _is_marker(value: object) -> bool:
    try:
        MarkerStyle(value)  # type: ignore[arg-type]
    except (ValueError, TypeError):
        return False
    return True


Colour = Annotated[str, _Drawn("colour", is_color_like)]
Marker = Annotated[str, _Drawn("marker", _is_marker)]

DRAWABLE = 1e30
"""Numbers beyond it have no place on an axis."""


def drawable(
    name: str, values: ArrayLike, shape: tuple[int | None, ...] | None = None
) -> np.ndarray:
    """Finite numbers that fit on an axis, of a shape in which None stands for any length >= 1."""
    array = finite_array(name, values)
    wanted = array.shape if shape is None else shape
    fits = len(wanted) == array.ndim and all(
        n in (None, m) for n, m in zip(wanted, array.shape, strict=True)
    )
    if not fits or array.size == 0:
        words = ", ".join("T" if n is None else str(n) for n in wanted)
        raise ArgumentError(f"{name} has shape {array.shape}; give ({words}), not empty")
    if np.abs(array).max() > DRAWABLE:
        raise ArgumentError(f"{name} reaches {np.abs(array).max():.1e}; draw in another unit")
    return array


@border
def panels(
    figure: Figure,
    rows: Panels = 1,
    columns: Panels = 1,
    *,
    kind: Kind | Sequence[Kind] = "plane",
    size: tuple[Inches, Inches] = (3.2, 2.9),
) -> list[Axes]:
    """Divide a figure into panels and set its size.

    Parameters
    ----------
    figure : Figure
        An empty figure.
    rows, columns : int
        Number of panels.
    kind : str or sequence of str
        ``"plane"`` or ``"curve"``; a sequence is repeated over the panels.
    size : (float, float)
        Width and height of one panel [inch].

    Returns
    -------
    list of Axes
        Row by row.
    """
    if not kind:
        raise ArgumentError("kind is empty; give 'plane' or 'curve'")
    figure.set_size_inches(columns * size[0], rows * size[1])
    figure.set_layout_engine("compressed")
    axes = [figure.add_subplot(rows, columns, i + 1) for i in range(rows * columns)]
    kinds = [kind] if isinstance(kind, str) else kind
    for axis, each in zip(axes, itertools.cycle(kinds), strict=False):
        style(axis, each)
    return axes


def style(axis: Axes, kind: Kind = "plane") -> None:
    """Apply the style to one pair of axes."""
    axis.set_facecolor("none")
    axis.spines[["top", "right"]].set_visible(False)
    axis.spines[["left", "bottom"]].set(color=INK, alpha=0.5, linewidth=0.8)
    axis.tick_params(color=INK, labelcolor=INK, labelsize=7.5, length=3, width=0.7)
    axis.locator_params(nbins=5)
    axis.set_axisbelow(True)
    for side in (axis.xaxis, axis.yaxis):
        side.label.set(color=INK, fontsize=8.5)
    if kind == "plane":
        axis.set_aspect("equal", adjustable="datalim")
    else:
        axis.grid(color=INK, alpha=0.1, lw=0.7)


@border
def title(axis: Axes, text: str) -> None:
    """Write a title above a panel."""
    axis.set_title(text, color=INK, fontsize=9)


@border
def legend(figure: Figure, columns: Count = 5) -> None:
    """Name every label once, below all panels."""
    handles: dict[str, Artist] = {}
    for axis in figure.axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if handles:
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=min(columns, len(handles)),
            frameon=False,
            fontsize=8.5,
            labelcolor=INK,
            handlelength=1.6,
        )


@border
def same_view(axes: Sequence[Axes], margin: NotNegative = 0.06) -> None:
    """Give panels the same limits, those that hold what is drawn in all of them."""
    if not axes:
        raise ArgumentError("axes is empty; give at least one")
    boxes = np.array([axis.dataLim.get_points() for axis in axes])
    low, high = boxes[:, 0].min(0), boxes[:, 1].max(0)
    room = margin * (high - low).max()
    for axis in axes:
        if axis.get_aspect() == 1:
            axis.set_aspect("equal", adjustable="box")
        axis.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))


@border
def shades(
    colour: Colour, count: Annotated[int, Range(least=0, most=1e6)], lightest: Opacity = 0.75
) -> list[str]:
    """Return ``count`` shades of a colour from light to full, for the course of time."""
    rgb = np.array(to_rgb(colour))
    white = np.linspace(lightest, 0.0, count) if count > 1 else np.zeros(count)
    return [to_hex(share + (1 - share) * rgb) for share in white]


@border
def save(
    figure: Figure, path: str | Path, *, dpi: Annotated[float, Range(least=10, most=2000)] = 110
) -> Path:
    """Write a figure as PNG on white paper, whole or not at all; no display is needed."""
    path = Path(path)
    if path.suffix != ".png":
        raise ArgumentError(
            f"path is {path}: pictures are written as PNG; give a name that ends in .png"
        )
    with whole_path(path, replace=True) as temporary:
        figure.savefig(temporary, dpi=dpi, facecolor="white", bbox_inches="tight", pad_inches=0.08)
    return path
