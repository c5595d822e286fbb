"""Samples over time: their phase, other times, derivatives, all from the stamps themselves."""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import affordable, array_of, finite_array
from tpsim.errors import ArgumentError, DataWarning

UNEVEN = 1e-3  # of the mean step: stamps that stray less count as evenly spaced


def phase(time: np.ndarray) -> np.ndarray:
    """Share of the duration (T,) that has passed at times (T,), from 0 to 1."""
    span = time[-1] - time[0]
    return (time - time[0]) / span if span > 0 else np.zeros_like(time)


def progress(time: np.ndarray) -> np.ndarray:
    """Phase (T,); exactly evenly spaced where the stamps are, up to their rounding."""
    return np.linspace(0.0, 1.0, len(time)) if evenly_spaced(time) else phase(time)


def rest_to_rest(phase: np.ndarray) -> np.ndarray:
    """Progress (T,) of a movement at rest at both ends, the smoothest, over its phase (T,)."""
    return phase**3 * (10 - 15 * phase + 6 * phase**2)


def rest_to_rest_rate(phase: np.ndarray) -> np.ndarray:
    """Rate (T,) of :func:`rest_to_rest`, per unit of phase."""
    return 30 * phase**2 * (1 - phase) ** 2


def evenly_spaced(time: np.ndarray) -> bool:
    """Whether stamps (T,) are those of a regular clock, up to rounding and a little jitter."""
    if len(time) < 3:
        return True
    even = np.linspace(time[0], time[-1], len(time))
    return bool(np.abs(time - even).max() <= UNEVEN * (even[1] - even[0]))


def weights(time: np.ndarray) -> np.ndarray:
    """Share of the duration (T,) for which each sample stands, summing to one."""
    if len(time) == 1:
        return np.ones(1)
    steps = np.diff(time)
    return (np.append(steps, 0.0) + np.append(0.0, steps)) / (2 * (time[-1] - time[0]))


def new_times(time: np.ndarray, wanted: int | ArrayLike) -> np.ndarray:
    """Times (S,) inside the span of ``time``: as they are given, or a number of them."""
    first, last = time[0], time[-1]
    if array_of("times", wanted).ndim == 0:
        count = wanted.item() if isinstance(wanted, np.generic | np.ndarray) else wanted
        if isinstance(count, float) and count.is_integer():
            count = int(count)
        return np.linspace(first, last, affordable("times", count, 64))
    times = finite_array("times", wanted)
    if times.ndim != 1 or times.size == 0 or times.min() < first or times.max() > last:
        raise ArgumentError(
            f"times must be (S,), inside the demonstration, {first} to {last} s, and not empty"
        )
    return times


def around(time: np.ndarray, wanted: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The samples before and after each wanted time, and how far it is between them, 0 to 1.

    Before the first and after the last sample the ends are held. Of two samples at one time, the
    second counts.
    """
    before = np.clip(np.searchsorted(time, wanted, side="right") - 1, 0, len(time) - 1)
    after = np.minimum(before + 1, len(time) - 1)
    span = time[after] - time[before]
    share = np.clip((wanted - time[before]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    return before, after, share


def interpolate(
    time: np.ndarray, values: np.ndarray, times: np.ndarray, smooth: bool = False
) -> np.ndarray:
    """Values (T, ...) at other times (S,), straight between samples, held at ends, or a spline."""
    if len(time) == 1:
        return np.repeat(values, len(times), axis=0)
    if smooth:
        if len(time) < 4:
            raise ArgumentError(f"a cubic spline needs 4 samples, {len(time)} were given")
        from scipy.interpolate import CubicSpline

        return CubicSpline(time, values)(times)
    before, after, share = around(time, times)
    share = share.reshape(-1, *(1,) * (values.ndim - 1))
    return (1 - share) * values[before] + share * values[after]


def differentiate(time: np.ndarray, values: np.ndarray, n: int) -> np.ndarray:
    """Stack values (T, D) and ``n`` forward derivatives, Eqs (21-22), (T, (n + 1) D).

    Divided differences, n! f[t_i ... t_{i+n}]: exact for polynomials of degree n, however the
    stamps are spaced. After its last sample the movement rests, with steps as long as the last.
    """
    step = time[-1] - time[-2] if len(time) > 1 else 1.0
    extended = np.concatenate([time, time[-1] + step * np.arange(1, n + 1)])
    columns = [values]
    for c in range(1, n + 1):
        last = columns[-1]
        rest = last[-1:] if c == 1 else np.zeros_like(last[-1:])
        reach = (extended[c:] - extended[: len(extended) - c])[: len(time)]
        columns.append(c * np.diff(np.concatenate([last, rest]), axis=0) / reach[:, None])
    return np.hstack(columns)


def check_even(name: str, times: list[np.ndarray]) -> None:
    """Raise an ArgumentError for uneven stamps, and give a DataWarning for different rates.

    For models that count samples; the same number of samples in every one is a clock as well.
    """
    for m, time in enumerate(times):
        if not evenly_spaced(time):
            steps = np.diff(time)
            i = int(np.abs(steps - np.median(steps)).argmax())
            raise ArgumentError(
                f"{name} {m} is sampled unevenly (steps of {steps.min():.3g} to "
                f"{steps.max():.3g} s, sample {i + 1} is out of step) and the model counts "
                "samples; give demonstration.resampled(T)"
            )
    steps = np.array([(t[-1] - t[0]) / (len(t) - 1) for t in times if len(t) > 1])
    if len({len(t) for t in times}) > 1 and len(steps) and np.ptp(steps) > 0.01 * steps.min():
        slow, fast = int(steps.argmax()), int(steps.argmin())
        warnings.warn(
            f"{name} {slow} has steps of {steps[slow]:.3g} s and {name} {fast} of "
            f"{steps[fast]:.3g} s, and the model counts samples: a stay in a state then lasts "
            "differently in seconds; give demonstration.resampled(...)",
            DataWarning,
            stacklevel=4,
        )
