"""The part of a movement that a robot can use: what is slower than a time scale, without delay."""

import numpy as np
from numpy.typing import ArrayLike

from tpsim import timeline
from tpsim.checks import Floats, column_or_matrix, number, stamps
from tpsim.errors import ArgumentError

ORDER = 2
"""Of the Butterworth filter; run forwards and backwards it counts twice."""

SLOWEST = 1e-6
"""Least cutoff, as a share of the rate: rounding leaves nothing of slower filters."""


def low_pass(time: ArrayLike, values: ArrayLike, cutoff: float) -> Floats:
    """Remove what is faster than a frequency, forwards and backwards in time: without delay.

    A Butterworth filter of second order in each direction: its gain is
    1 / (1 + (f / cutoff)^4), a half at the cutoff, 6 % at twice and 0.4 % at four times the
    frequency, and one within 2 % below a third of it. With a cutoff of 4 Hz the tremor of a
    hand, at 8 to 12 Hz, loses 94 to 99 %; a controller that tracks it would shake. Drift, below
    1 Hz, stays: it is what demonstrations tell of a person's precision.

    Parameters
    ----------
    time : (T,)
        Evenly spaced stamps [s].
    values : (T,) or (T, D)
        Continuous: joint angles, positions; not quaternions that change sign.
    cutoff : float
        Frequency at which half of the amplitude is left [Hz]; the time scale is
        1 / (2 pi cutoff).

    Returns
    -------
    ndarray
        Of the shape of ``values``; the ends are continued by point reflection.

    Raises
    ------
    ArgumentError
        Uneven stamps, fewer than two samples, or a cutoff that is not below half of the rate and
        above a millionth of it.
    """
    from scipy.signal import butter, sosfiltfilt  # slow to import: only people's hands need it

    time, rows = stamps("time", time), column_or_matrix("values", values)
    if len(rows) != len(time) or len(time) < 2:
        raise ArgumentError(
            f"time has {len(time)} and values {len(rows)} samples; give two or more pairs"
        )
    if not timeline.evenly_spaced(time):
        raise ArgumentError("time is spaced unevenly; give even stamps, as Demonstration.resampled")
    rate = (len(time) - 1) / (time[-1] - time[0])
    cutoff = number(
        f"cutoff [Hz], of {rate:.3g} samples by time [s],",
        cutoff,
        above=SLOWEST * rate,
        below=rate / 2,
    )
    sections = butter(ORDER, cutoff, fs=rate, output="sos")
    # As long as the filter remembers, where the movement is as long as that.
    ends = min(len(time) - 1, round(3 * rate / cutoff))
    filtered: Floats = sosfiltfilt(sections, rows, axis=0, padlen=ends)
    return filtered.reshape(np.shape(values))
