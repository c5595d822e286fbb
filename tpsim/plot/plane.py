"""Movements in the plane as the tutorial draws them: paths, Gaussians, flow tubes, frames as U."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from numpy.typing import ArrayLike

from tpsim.border import Positive, border
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.plot.style import INK, PALETTE, Colour, Marker, Opacity, drawable, shades

U_SHAPE = np.array([[-0.2, 0.3], [-0.2, -0.1], [0.2, -0.1], [0.2, 0.3]])
"""Corners of an object in its own frame [m]; its open side is the second axis."""


@border
def demonstrations(
    axis: Axes,
    paths: Iterable[Demonstration | ArrayLike],
    *,
    colour: Colour = INK,
    label: str | None = None,
) -> None:
    """Draw demonstrated paths as thin faint lines.

    Parameters
    ----------
    paths : iterable of Demonstration or (T, 2) arrays
        Of data with more columns the first two are drawn.
    label : str, optional
        For the legend.
    """
    for i, path in enumerate(paths):
        given = path.data if isinstance(path, Demonstration) else path
        data = drawable(f"paths[{i}]", given)
        if data.ndim != 2 or data.shape[1] < 2:
            raise ArgumentError(f"paths[{i}] has shape {data.shape}; give (T, 2)")
        axis.plot(*data[:, :2].T, color=colour, lw=0.8, alpha=0.35, label=label, zorder=1)


@border
def ellipses(
    axis: Axes,
    gaussian: Gaussian,
    colour: Colour = PALETTE[0],
    *,
    fill: Opacity = 0.25,
    label: str | None = None,
) -> None:
    """Draw Gaussians in the plane as ellipses of one standard deviation, with their centres.

    Parameters
    ----------
    gaussian : Gaussian (..., 2)
    fill : float
        Opacity of the inside; 0 draws outlines alone.
    """
    outlines = _outlines("gaussian", gaussian)
    collection = PolyCollection(
        list(outlines), facecolors=to_rgba(colour, fill), edgecolors=colour, lw=1.0, zorder=2
    )
    collection.set_label(label or "")
    _add(axis, collection, outlines)
    axis.plot(*gaussian.mean.reshape(-1, 2).T, ".", color=colour, ms=4, zorder=3)


@border
def tube(
    axis: Axes,
    path: Gaussian,
    colour: Colour = PALETTE[1],
    *,
    label: str | None = None,
) -> None:
    """Draw a movement with its spread: the mean, in a tube of one standard deviation.

    Parameters
    ----------
    path : Gaussian (T, 2)
        One Gaussian per time step.
    """
    outlines = _outlines("path", _between(path))
    light = shades(colour, 5, 0.8)[0]
    # Opaque, so that ellipses that overlap make one even tube.
    _add(axis, PolyCollection(list(outlines), facecolors=light, lw=0, zorder=0.5), outlines)
    axis.plot(*path.mean.T, color=colour, lw=1.8, label=label, zorder=3)


@border
def points(
    axis: Axes,
    places: ArrayLike,
    colour: Colour = INK,
    *,
    marker: Marker = "o",
    label: str | None = None,
) -> None:
    """Mark places (..., 2), such as targets or via points."""
    given = drawable("places", places)
    if given.shape[-1:] != (2,):
        raise ArgumentError(f"places have shape {given.shape}; give (..., 2)")
    columns = given.reshape(-1, 2).T
    axis.plot(*columns, marker, color=colour, ms=6, mew=1.6, label=label, zorder=4)


@border
def frames(
    axis: Axes,
    frames: Sequence[Frame],
    colours: Sequence[Colour] = PALETTE[2:],
    *,
    size: Positive = 1.0,
    labels: Sequence[str] = (),
) -> None:
    """Draw frames of reference as the tutorial's U-shaped objects, open along the second axis.

    Parameters
    ----------
    frames : sequence of Frame
        Constant frames in the plane; 2 x 2 matrices A.
    colours : sequence of str
        One per frame, repeated where there are more frames.
    size : float
        Scale of the U; 1 is an object 0.4 m wide.
    labels : sequence of str, optional
        For the legend.
    """
    if not colours:
        raise ArgumentError("colours is empty; give at least one")
    for j, frame in enumerate(frames):
        if frame.A.shape != (2, 2):
            raise ArgumentError(
                f"frame {j} has A of shape {frame.A.shape}; only constant frames in the plane, "
                "with A of shape (2, 2), can be drawn"
            )
        corners = drawable(f"frames[{j}]", frame.to_common(size * U_SHAPE))
        axis.plot(
            *corners.T,
            color=colours[j % len(colours)],
            lw=3.5,
            solid_joinstyle="miter",
            solid_capstyle="butt",
            label=labels[j] if j < len(labels) else None,
            zorder=2.5,
        )


def _between(path: Gaussian, pieces: int = 4) -> Gaussian:
    """Put Gaussians between those of consecutive steps, so that a tube has no notches."""
    if path.mean.ndim != 2:
        raise ArgumentError(f"path has means of shape {path.mean.shape}; give (T, 2)")
    places = np.linspace(0, len(path.mean) - 1, pieces * (len(path.mean) - 1) + 1)
    before = np.minimum(places.astype(int), max(len(path.mean) - 2, 0))
    after = np.minimum(before + 1, len(path.mean) - 1)
    share = places - before
    return Gaussian(
        path.mean[before] + share[:, None] * (path.mean[after] - path.mean[before]),
        path.covariance[before]
        + share[:, None, None] * (path.covariance[after] - path.covariance[before]),
    )


def _outlines(name: str, gaussian: Gaussian, corners: int = 48) -> np.ndarray:
    """Ellipses of one standard deviation (N, corners, 2)."""
    if gaussian.mean.shape[-1] != 2:
        raise ArgumentError(
            f"{name} has dimension {gaussian.mean.shape[-1]}; choose two coordinates with "
            ".marginal([i, j])"
        )
    angle = np.linspace(0, 2 * np.pi, corners)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    drawable(name, gaussian.mean)
    drawable(name, gaussian.covariance)
    eigenvalues, V = np.linalg.eigh(gaussian.covariance)
    roots = V * np.sqrt(np.maximum(eigenvalues, 0))[..., None, :]
    outlines = gaussian.mean[..., None, :] + circle @ np.swapaxes(roots, -1, -2)
    return outlines.reshape(-1, corners, 2)


def _add(axis: Axes, collection: PolyCollection, outlines: np.ndarray) -> None:
    axis.add_collection(collection, autolim=False)
    axis.update_datalim(outlines.reshape(-1, 2))
    axis.autoscale_view()
