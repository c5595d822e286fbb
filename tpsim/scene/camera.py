"""A camera of a scene."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import Point, Range, checked


@dataclass(frozen=True)
class Camera:
    """A camera at a position that looks at a target, upright.

    Parameters
    ----------
    position, target : (3,)
        [m]
    fovy : float
        Vertical field of view [deg].
    """

    position: Point
    target: Point
    fovy: Annotated[float, Range(above=0, below=180)] = 32.0

    def __post_init__(self) -> None:
        checked(self)


def upright(backward: ArrayLike) -> np.ndarray:
    """Axes of an upright camera in the rows (3, 3): to its right, up, and backward (3,)."""
    back = np.asarray(backward, float)
    right = np.cross((0.0, 0.0, 1.0), back)
    axes = np.stack([right, np.cross(back, right), back])
    unit: np.ndarray = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    return unit
