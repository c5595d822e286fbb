"""Curves with their spread, and matrices as images."""

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from tpsim.border import border
from tpsim.plot.style import INK, PALETTE, Colour, drawable


@border
def band(
    axis: Axes,
    x: ArrayLike,
    mean: ArrayLike,
    deviation: ArrayLike,
    colour: Colour = PALETTE[1],
    *,
    label: str | None = None,
) -> None:
    """Draw a curve with a band of one standard deviation.

    Parameters
    ----------
    x, mean, deviation : (T,)
    """
    x = drawable("x", x, (None,))
    mean, deviation = drawable("mean", mean, x.shape), drawable("deviation", deviation, x.shape)
    axis.fill_between(x, mean - deviation, mean + deviation, color=colour, alpha=0.2, lw=0)
    axis.plot(x, mean, color=colour, lw=1.8, label=label)


@border
def matrix(axis: Axes, values: ArrayLike) -> None:
    """Draw a matrix as an image, positive red, negative blue, zero white.

    Parameters
    ----------
    values : (n, m)
        Such as a covariance.
    """
    values = drawable("values", values, (None, None))
    limit = max(float(np.abs(values).max()), 1e-300)
    axis.imshow(values, cmap="RdBu_r", vmin=-limit, vmax=limit, interpolation="nearest")
    axis.set_aspect("equal", adjustable="box")
    axis.set(xticks=[], yticks=[])
    axis.spines[:].set(visible=True, color=INK, alpha=0.5, linewidth=0.8)
