"""What a scene file does not say about the robot in it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from tpsim.robot.intake import Source


@dataclass(frozen=True)
class Description:
    """What a scene file does not say about the robot in it; part of ``run.json``.

    Parameters
    ----------
    joints : tuple of str
        The arms' joints, in the order of q.
    hands : mapping of str to str
        Sites of the hands, by name.
    velocity_limit, home : (n,) tuple
        [rad/s], [rad]; a limit of None is none.
    fixed : mapping of str to float
        Joints that are no arm, and the position [rad] at which the model takes them as fixed.
    controls : mapping of str to float
        Actuators of those joints, and the control that keeps them there.
    """

    joints: tuple[str, ...]
    hands: dict[str, str]
    velocity_limit: tuple[float | None, ...]
    home: tuple[float, ...]
    fixed: dict[str, float]
    controls: dict[str, float]

    @classmethod
    def of(cls, source: "Source") -> "Description":
        """Description of what the intake took over."""
        limits = [float(v) if np.isfinite(v) else None for v in source.velocity_limit]
        home = tuple(float(angle) for angle in source.home)
        return cls(
            source.joints,
            dict(source.hands),
            tuple(limits),
            home,
            dict(source.others),
            dict(source.controls),
        )
