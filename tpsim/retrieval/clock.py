"""Demonstrations on one clock: the same duration and the same sampling for all."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tpsim.border import Count, border
from tpsim.checks import affordable
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError


@border
def on_one_clock(
    demonstrations: Sequence[Demonstration], samples: Count | None = None
) -> list[Demonstration]:
    """Demonstrations stretched to one duration, and sampled at the same, equally spaced times.

    Parameters
    ----------
    demonstrations
        Of any lengths. Each is stretched evenly: slow and fast ones are taken to differ in speed
        alone. Align them by :func:`tpsim.learning.dtw.align` first where that is not so.
    samples
        Number T of samples; by default the median of the lengths.

    Returns
    -------
    list of Demonstration
        With times (T,) from 0 to the median duration [s].

    Raises
    ------
    ArgumentError
        No demonstration, fewer than two samples, or frames or dimensions that differ.
    """
    if not demonstrations:
        raise ArgumentError("there is no demonstration; give at least one")
    shapes = {(d.data.shape[1], tuple(o.shape[1] for o in d.observations)) for d in demonstrations}
    if len(shapes) > 1:
        raise ArgumentError(
            "the demonstrations have (dimension, dimensions in the frames) "
            f"{sorted(shapes)}; all need the same frames and the same data"
        )
    samples = int(np.median([len(d) for d in demonstrations])) if samples is None else samples
    affordable("samples", samples, 64 * len(demonstrations))
    if samples < 2 or min(map(len, demonstrations)) < 2:
        raise ArgumentError("a movement needs at least 2 samples; give longer demonstrations")
    duration = float(np.median([d.time[-1] - d.time[0] for d in demonstrations]))
    times = np.linspace(0.0, duration, samples)
    return [_stretched(demonstration, times) for demonstration in demonstrations]


def _stretched(demonstration: Demonstration, times: np.ndarray) -> Demonstration:
    passed = demonstration.time - demonstration.time[0]
    if len(passed) == len(times) and np.allclose(passed, times, rtol=0, atol=1e-9 * times[-1]):
        return replace(demonstration, time=times)
    progress = np.clip(passed / passed[-1], 0.0, 1.0)
    stretched = replace(demonstration, time=progress * times[-1])
    return replace(stretched.resampled(np.minimum(times, stretched.time[-1])), time=times)
