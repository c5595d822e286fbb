"""What is measured of forces and movements, for measures and figures."""

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.world.trial import Trial


def interval(wrench: np.ndarray, time: np.ndarray) -> tuple[float, float] | None:
    """First and last time (s) at which a wrench (T, 6) acts; None where it never does."""
    acting = np.flatnonzero(np.any(wrench, axis=-1))
    return (float(time[acting[0]]), float(time[acting[-1]])) if len(acting) else None


def push_interval(trial: Trial) -> tuple[float, float] | None:
    """First and last time (s) of the push of a trial; None where nothing was pushed."""
    wrench = trial.arrays.get("push_wrench")
    return None if wrench is None else interval(wrench, trial.time)


def displacement(trial: Trial, twin: Trial, point: str) -> np.ndarray:
    """Distance (T,) m between a point of a pushed trial and of its unpushed twin.

    Parameters
    ----------
    trial, twin : Trial
        The same seed with and without the push; the shorter one sets T.
    point : str
        Name of a position signal, such as ``"left_hand_position"``.
    """
    length = min(len(trial.time), len(twin.time))
    if not np.array_equal(trial.time[:length], twin.time[:length]):
        raise ArgumentError("the trial and its twin were recorded on different clocks")
    moved: np.ndarray = trial[point][:length] - twin[point][:length]
    return np.linalg.norm(moved, axis=-1)


def work(wrench: np.ndarray, position: np.ndarray) -> float:
    """Work (J) that the force of a wrench (T, 6) does along the path (T, 3) of its point.

    The trapezoidal rule over the path: the sum of (f_t + f_{t+1})/2 . (x_{t+1} - x_t).
    """
    force = wrench[:, :3]
    return float(np.sum((force[1:] + force[:-1]) / 2 * np.diff(position, axis=0)))


def mean_force(wrench: np.ndarray) -> float:
    """Mean size (N) of the force of a wrench (T, 6) while it acts; zero where it never does."""
    size = np.linalg.norm(wrench[:, :3], axis=-1)
    return float(size[size > 0].mean()) if np.any(size > 0) else 0.0
