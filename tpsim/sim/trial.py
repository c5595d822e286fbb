"""One trial: what happened on the robot, by name and on one clock."""

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Trial:
    """What one simulated trial left behind.

    Parameters
    ----------
    arrays : dict of str to ndarray
        Signals sampled at 100 Hz by the names of DESIGN: ``time (T,)`` s, ``q (T, n)`` rad,
        ``torque (T, n)`` Nm, ``left_hand_position (T, 3)`` m, ``push_wrench (T, 6)`` N, Nm, ...
    outcome : str
        ``"done"``, or why it ended or does not count: ``"diverged"``, ``"contact"``,
        ``"joint limit"``, ``"saturated"``. A failure is data here, not an exception.
    about : dict
        What is needed to run it again, as plain JSON values: task, controller, seed, situation,
        push.
    """

    arrays: dict[str, np.ndarray]
    outcome: str = "done"
    about: dict = field(default_factory=dict)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the signal called ``name``."""
        return self.arrays[name]
