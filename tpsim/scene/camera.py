"""A camera of a scene."""

from dataclasses import dataclass
from typing import Annotated

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
