"""What matters to a person who leads: where a hand is steadier, and which errors are mended."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import checked
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Care:
    """What matters to a person who leads, and when: 0 not at all, 1 fully.

    Parameters
    ----------
    position, rotation : (3,) or (T, 3)
        Along, and about, the axes of the frame in which the path is.
    """

    position: ArrayLike = (0.0, 0.0, 0.0)
    rotation: ArrayLike = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        checked(self)
        for name in ("position", "rotation"):
            shape = np.shape(getattr(self, name))
            if shape[-1:] != (3,) or len(shape) > 2 or 0 in shape:
                raise ArgumentError(f"care {name} has shape {shape}; give (3,) or (T, 3)")

    def at(self, step: int) -> np.ndarray:
        """How much position and rotation (6,) matter at a step of the path."""
        parts = (np.asarray(part, float) for part in (self.position, self.rotation))
        return np.concatenate([p if p.ndim == 1 else p[min(step, len(p) - 1)] for p in parts])


EVERYTHING = Care((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
"""All matters, always."""
