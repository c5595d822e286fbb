"""Bodies with links: planar arms and stick figures."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from tpsim.border import NotNegative, Number, border
from tpsim.checks import finite_array
from tpsim.control.planar import PlanarChain
from tpsim.errors import ArgumentError
from tpsim.plot.style import INK, Colour, drawable, shades


@border
def arm(
    axis: Axes,
    chain: PlanarChain,
    postures: ArrayLike,
    colour: Colour = INK,
    label: str | None = None,
) -> None:
    """Draw postures of a planar arm, from light to dark in the order given.

    Parameters
    ----------
    chain : PlanarChain
    postures : (n,) or (T, n)
        Joint angles [rad].
    """
    postures = drawable("postures", np.atleast_2d(finite_array("postures", postures)))
    if postures.ndim != 2 or postures.shape[1] != chain.size:
        raise ArgumentError(f"postures have shape {postures.shape}; give (T, {chain.size})")
    for i, (q, shade) in enumerate(zip(postures, shades(colour, len(postures)), strict=True)):
        last = i + 1 == len(postures)
        axis.plot(
            *chain.points(q).T,
            color=shade,
            lw=4,
            marker="o",
            ms=4.5,
            mfc="white",
            mew=1,
            solid_capstyle="round",
            label=label if last else None,
            zorder=1 + i / len(postures),
        )
    axis.plot(0, 0, "s", color=INK, ms=7, zorder=2.2)


@border
def skeleton(
    axis: Axes,
    joints: ArrayLike,
    bones: Sequence[tuple[Number, Number]],
    colour: Colour = INK,
    *,
    width: NotNegative = 1.8,
    label: str | None = None,
) -> None:
    """Draw a stick figure.

    Parameters
    ----------
    joints : (J, 2)
        Positions of the joints in the plane of the picture [m].
    bones : sequence of (int, int)
        Pairs of joints that a bone connects.
    """
    joints = drawable("joints", joints, (None, 2))
    if bones and np.max(bones) >= len(joints):
        raise ArgumentError(f"bones name joint {np.max(bones)}; joints has {len(joints)} of them")
    for i, (start, end) in enumerate(bones):
        axis.plot(
            *joints[[start, end]].T,
            color=colour,
            lw=width,
            solid_capstyle="round",
            label=label if i == 0 else None,
        )
