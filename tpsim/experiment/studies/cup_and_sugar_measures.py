"""What is measured of cup and sugar, and with what they are tried."""

from collections.abc import Mapping

import numpy as np

from tpsim import rotation
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.trial import Trial

DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
"""Of the pushes: +x, +y, +z, -x, -y, -z."""

PUSH, ELBOW_PUSH = 20.0, 15.0
"""Forces [N] on the left hand and on the right elbow, for two seconds."""

TRAVEL = 0.15
"""How far the left hand is led [m]."""


def tilt(trial: Trial) -> np.ndarray:
    """Angle (T,) [deg] of the cup's axis from the vertical."""
    return np.degrees(rotation.tilt(rotation.from_quaternion(trial["cup_quaternion"])))


def taught_place(models: Mapping[str, TPGMM]) -> np.ndarray:
    """Where the sugar was taught to be, in the cup's frame (3,) [m]."""
    model = models["sugar"]
    return model.priors @ model.frames[2].mean[:, :3]


def offset(trial: Trial, place) -> np.ndarray:
    """Distance (T,) [mm] of the sugar from a place in the cup's frame."""
    R = rotation.from_quaternion(trial["cup_quaternion"])
    seen = np.einsum("tji,tj->ti", R, trial["sugar_position"] - trial["cup_position"])
    return 1e3 * np.linalg.norm(seen - place, axis=1)
