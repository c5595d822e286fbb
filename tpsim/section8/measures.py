"""What is measured of one retrieved movement."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import LOG_2PI, Gaussian
from tpsim.section8.method import Path

PIECE = 0.1
"""Length of the last piece of a path, whose direction is measured, as a share of the truth's."""


@dataclass(frozen=True)
class Figure:
    """How a measured figure is named and read.

    Parameters
    ----------
    title : str
    unit : str
    best : float or None
        The value that a perfect method has; None where lower is better without a bound.
    """

    title: str
    unit: str = ""
    best: float | None = 0.0


FIGURES: dict[str, Figure] = {
    "rms": Figure("distance from the teacher, rms", "m"),
    "end": Figure("end error", "m"),
    "direction": Figure("approach direction error", "deg"),
    "nll": Figure("negative log-likelihood of a sample", "nats", None),
    "inside_50": Figure("share inside the 50 % tube", "", 0.5),
    "inside_95": Figure("share inside the 95 % tube", "", 0.95),
    "jerk": Figure("log dimensionless jerk", "", None),
}
"""Figures of :func:`measure`, in the order of tables."""


def measure(
    path: Path, truth: Demonstration, drawn: Demonstration | None = None
) -> dict[str, float]:
    """Measure a retrieved movement against what the teacher does in the same situation.

    Parameters
    ----------
    path : Gaussian (T, D) or array (T, D)
        The movement, at the times of ``truth``.
    truth : Demonstration
        The teacher's movement.
    drawn : Demonstration, optional
        One as it would be demonstrated, with the teacher's free variation, which the
        distribution should cover; ``truth`` by default.

    Returns
    -------
    dict
        ``rms`` distance over time and ``end`` error, in the unit of the data; ``direction`` [deg]
        between the last pieces of both paths, a tenth of the truth's length; ``nll`` [nats], mean
        over the samples; ``inside_50``, ``inside_95``, shares of samples inside those tubes (all
        three NaN without a distribution); ``jerk``, the log dimensionless jerk
        ln(T^3 / v_peak^2 integral |x'''|^2) of [Hogan and Sternad 2009], lower is smoother.

    Raises
    ------
    ArgumentError
        A path of another shape than the truth, or NaN in it.
    """
    x = path.mean if isinstance(path, Gaussian) else np.asarray(path, float)
    if x.shape != truth.data.shape:
        raise ArgumentError(f"retrieved {x.shape}; the situation asks for {truth.data.shape}")
    if not np.isfinite(x).all():
        raise ArgumentError("retrieved NaN or infinite positions")
    figures = {
        "rms": float(np.sqrt(((x - truth.data) ** 2).sum(1).mean())),
        "end": float(np.linalg.norm(x[-1] - truth.data[-1])),
        "direction": _angle(_last_piece(x, truth.data), _last_piece(truth.data, truth.data)),
        "nll": np.nan,
        "inside_50": np.nan,
        "inside_95": np.nan,
        "jerk": _log_jerk(x, float(truth.time[-1] - truth.time[0])),
    }
    if isinstance(path, Gaussian):
        figures |= _of_distribution(path, (drawn or truth).data)
    return figures


def _of_distribution(path: Gaussian, data: NDArray) -> dict[str, float]:
    """Negative log-likelihood and coverage of samples (T, D)."""
    eigenvalues, V = np.linalg.eigh(path.covariance)
    eigenvalues = np.maximum(eigenvalues, np.finfo(float).tiny ** 0.5)
    white = np.einsum("tij,ti->tj", V, data - path.mean)
    squares = (white**2 / eigenvalues).sum(1)
    nll = 0.5 * (squares + np.log(eigenvalues).sum(1) + path.dim * LOG_2PI)
    inside = (squares[:, None] <= chi2.ppf([0.5, 0.95], path.dim)).mean(0)
    return {
        "nll": float(nll.mean()),
        "inside_50": float(inside[0]),
        "inside_95": float(inside[1]),
    }


def _last_piece(x: NDArray, truth: NDArray) -> NDArray:
    """Vector from the end of a path back to where it enters the last tenth of the way."""
    length = PIECE * float(np.linalg.norm(np.diff(truth, axis=0), axis=1).sum())
    away = np.linalg.norm(x - x[-1], axis=1)
    outside = np.flatnonzero(away > length)
    return np.asarray(x[outside[-1] if len(outside) else 0] - x[-1])


def _angle(a: NDArray, b: NDArray) -> float:
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(np.degrees(np.arccos(np.clip(a @ b / size, -1, 1)))) if size > 0 else np.nan


def _log_jerk(x: NDArray, duration: float) -> float:
    if len(x) < 4:
        return np.nan
    dt = duration / (len(x) - 1)
    peak = float((np.diff(x, axis=0) ** 2).sum(1).max()) / dt**2
    jerk = float(((np.diff(x, 3, axis=0) / dt**3) ** 2).sum()) * dt
    return float(np.log(duration**3 * jerk / peak)) if peak > 0 and jerk > 0 else np.nan
