"""Movements in the plane, drawn like the tutorial's: paths, their spread, U-shaped objects."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes

from tpsim.demonstration import Demonstration
from tpsim.study.canvas import INK, PALETTE
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian


def draw_demonstrations(axis: Axes, demonstrations: Iterable[Demonstration]) -> None:
    """Draw demonstrated paths, faint."""
    for demonstration in demonstrations:
        axis.plot(*demonstration.data[:, :2].T, color=INK, lw=0.6, alpha=0.3)
    axis.set_aspect("equal")


def draw_ellipses(axis: Axes, gaussian: Gaussian, colour: str = PALETTE[0]) -> None:
    """Draw the ellipse of one standard deviation of every Gaussian (N, 2)."""
    angle = np.linspace(0, 2 * np.pi, 40)
    eigenvalues, V = np.linalg.eigh(gaussian.covariance)
    roots = V * np.sqrt(np.maximum(eigenvalues, 0))[..., None, :]
    for mean, root in zip(gaussian.mean, roots, strict=True):
        ellipse = mean[:, None] + root @ [np.cos(angle), np.sin(angle)]
        axis.fill(*ellipse, color=colour, alpha=0.12, lw=0)


def draw_path(axis: Axes, path: Gaussian, colour: str = PALETTE[0], every: int = 10) -> None:
    """Draw a retrieved movement (T, 2): its mean, and its spread every few steps."""
    draw_ellipses(axis, path[::every], colour)
    axis.plot(*path.mean.T, color=colour, lw=1.8)
    axis.set_aspect("equal")


def draw_frames(axis: Axes, frames: Sequence[Frame]) -> None:
    """Draw every frame as a U whose open side is its second axis."""
    corners = [[-0.2, 0.3], [-0.2, -0.1], [0.2, -0.1], [0.2, 0.3]]
    for frame, colour in zip(frames, PALETTE[1:], strict=False):
        axis.plot(*frame.to_common(corners).T, color=colour, lw=2.5)
    axis.set_aspect("equal")
