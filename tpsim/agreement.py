"""Quaternions and angles that agree within and across recordings.

q and -q are one rotation, an angle and the angle plus 2 pi are one direction: recorders choose
between them by chance, and a mean over several recordings is nonsense unless all choose alike.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tpsim.checks import dimensions, several
from tpsim.errors import ArgumentError, DataWarning
from tpsim.rotation import continuous

if TYPE_CHECKING:
    from tpsim.demonstration import Demonstration

TURN = 2 * np.pi
UNIT = 1e-3  # how far from one the squared length of a recorded unit quaternion may be
PHASES = 33  # places along the movement at which recordings are compared


def agree(
    demonstrations: Sequence[Demonstration],
    *,
    quaternions: int | Sequence[int] | None = None,
    angles: int | Sequence[int] | None = None,
) -> list[Demonstration]:
    """Bring the quaternions and angles of several demonstrations to one sign and one turn.

    Parameters
    ----------
    demonstrations : sequence of Demonstration
        The first decides.
    quaternions : int or sequence of int, optional
        First column of each unit quaternion, w, x, y, z, in the data and in views of equal width.
        Default: four successive columns of unit length in every sample.
    angles : int or sequence of int, optional
        Columns that hold angles [rad]. Default: columns that jump by a whole turn, up to a
        quarter, between neighbouring samples, and otherwise move in small steps inside one turn.

    Returns
    -------
    list of Demonstration
        The same objects where there was nothing to do.

    Notes
    -----
    Every function that learns from demonstrations does this first, and gives a DataWarning when
    it changed something. Call it yourself to name the columns, and to keep the result.
    """
    from tpsim.demonstration import Demonstration

    demonstrations = several("demonstrations", demonstrations, Demonstration)
    widths = {d.data.shape[1] for d in demonstrations}
    seen = {tuple(view.shape[1] for view in d.observations) for d in demonstrations}
    if not widths:
        return demonstrations
    width = min(widths)
    if len(widths) > 1 and not (quaternions is None and angles is None):
        raise ArgumentError(
            f"demonstrations have {sorted(widths)} columns; give recordings of one width, or name "
            "no columns"
        )
    named = (
        None if quaternions is None else dimensions("quaternions", quaternions, width),
        None if angles is None else dimensions("angles", angles, width),
    )
    if named[0] is not None and named[0].max() + 4 > width:
        raise ArgumentError(f"quaternions {quaternions} need four columns each, of {width}")
    if len(widths) != 1 or len(seen) != 1:
        return demonstrations
    data = agreed([d.data for d in demonstrations], *named)
    views = [
        agreed(list(view), *(named if view[0].shape[1] == width else (None, None)))
        for view in zip(*(d.observations for d in demonstrations), strict=True)
    ]
    result = []
    for m, one in enumerate(demonstrations):
        seen_now = [view[m] for view in views]
        kept = data[m] is one.data and all(
            new is old for new, old in zip(seen_now, one.observations, strict=True)
        )
        result.append(
            one if kept else Demonstration(one.time, data[m], one.frames, seen_now, one.name)
        )
    return result


def agreed_with_warning(demonstrations: Sequence[Demonstration]) -> list[Demonstration]:
    """What :func:`agree` returns, with a DataWarning that names what it changed."""
    result = agree(demonstrations)
    changed = [m for m, (a, b) in enumerate(zip(demonstrations, result, strict=True)) if a is not b]
    if changed:
        warnings.warn(
            f"demonstrations {changed} hold quaternions of another sign or angles that wrap "
            "round; they were brought into agreement. Call tpsim.agree(demonstrations) yourself "
            "to see and keep the result",
            DataWarning,
            stacklevel=4,
        )
    return result


def agreed(
    recordings: list[np.ndarray],
    quaternions: np.ndarray | None = None,
    angles: np.ndarray | None = None,
) -> list[np.ndarray]:
    """Recordings (T_m, D) whose quaternions and angles agree; untouched ones are the same."""
    first = _unit_columns(recordings) if quaternions is None else quaternions
    turning = _wrapped_columns(recordings) if angles is None else angles
    if len(first) == 0 and len(turning) == 0:
        return recordings
    result = [np.array(recording) for recording in recordings]
    for column in first:
        block = slice(column, column + 4)
        for recording in result:
            recording[:, block] = continuous(recording[:, block])
            overlap = (_along(recording[:, block]) * _along(result[0][:, block])).sum()
            recording[:, block] *= -1.0 if overlap < 0 else 1.0
    for column in turning:
        for recording in result:
            recording[:, column] = np.unwrap(recording[:, column])
            apart = np.mean(_along(recording[:, column]) - _along(result[0][:, column]))
            recording[:, column] -= TURN * np.round(apart / TURN)
    return [
        old if np.array_equal(old, new) else new
        for old, new in zip(recordings, result, strict=True)
    ]


def warn_of_jumps(recording: np.ndarray, name: str = "") -> None:
    """Give a DataWarning where a quaternion changes its sign or an angle wraps in (T, D)."""
    if agreed([recording])[0] is not recording:
        warnings.warn(
            f"demonstration {name!r} holds a quaternion that changes its sign or an angle that "
            "wraps round: derivatives jump there; call tpsim.agree([demonstration]) first",
            DataWarning,
            stacklevel=3,
        )


def _along(values: np.ndarray) -> np.ndarray:
    """Rows at a few places along the recording."""
    return values[np.linspace(0, len(values) - 1, PHASES).round().astype(int)]


def _unit_columns(recordings: list[np.ndarray]) -> list[int]:
    """First columns of quaternions: four columns of unit length everywhere."""
    found: list[int] = []
    for column in range(recordings[0].shape[1] - 3):
        if found and column < found[-1] + 4:
            continue
        if all(_unit(recording[:, column : column + 4]) for recording in recordings):
            found.append(column)
    return found


def _unit(block: np.ndarray) -> bool:
    first = block[0] @ block[0]  # most columns fail here, at no cost
    return abs(first - 1) < UNIT and bool((abs((block**2).sum(1) - 1) < UNIT).all())


def _wrapped_columns(recordings: list[np.ndarray]) -> list[int]:
    """Columns that jump by a turn in some recording, and otherwise move in small steps."""
    wraps = np.zeros(recordings[0].shape[1], bool)
    small = ~wraps
    for recording in recordings:
        if len(recording) < 4:
            continue
        low, high = recording.min(0), recording.max(0)
        small &= high - low <= TURN * (1 + 1e-6)
        if not (small & (high - low > 0.75 * TURN)).any():
            continue
        steps = np.abs(np.diff(recording, axis=0))
        jumps = steps > 0.75 * TURN
        small &= np.where(jumps, 0.0, steps).max(0) < 0.25 * TURN
        wraps |= jumps.any(0)
    return [int(column) for column in np.flatnonzero(wraps & small)]
