"""Demonstrations and trials as named signals on one clock: what every exporter writes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError

Item = Demonstration | Mapping[str, Any]
"""A demonstration, or a trial: arrays (T, ...) by name, one of which is ``time``."""


@dataclass(frozen=True, eq=False)
class Signals:
    """Time (T,) [s] and signals (T, d) by name."""

    name: str
    time: np.ndarray
    columns: Mapping[str, np.ndarray]

    @property
    def rate(self) -> float:
        """Samples per second, by the median step [Hz]."""
        if len(self.time) < 2:
            return 1.0
        return float(1 / np.median(np.diff(self.time)))

    def at_rate(self, rate: float) -> "Signals":
        """Signals at even stamps, by straight lines; the same where they already are."""
        steps = np.diff(self.time)
        if not len(steps) or np.abs(steps - 1 / rate).max() < 1e-4 / rate:
            return self
        count = int((self.time[-1] - self.time[0]) * rate + 1e-6) + 1
        time = self.time[0] + np.arange(count) / rate
        columns = {
            name: np.column_stack([np.interp(time, self.time, column) for column in values.T])
            for name, values in self.columns.items()
        }
        return replace(self, time=time, columns=columns)

    def state(self, names: Sequence[str] | None) -> list[str]:
        """Signals that are the state: as given, else ``data`` or ``q``.

        Raises
        ------
        ArgumentError
            There is none; the message names those that are there.
        """
        chosen = [n for n in ("data", "q") if n in self.columns][:1] if names is None else names
        missing = [name for name in chosen if name not in self.columns]
        if missing or not chosen:
            raise ArgumentError(
                f"{self.name}: there is no signal {missing[0] if missing else 'data or q'}; name "
                f"the state, one or more of {', '.join(self.columns)}"
            )
        return list(chosen)

    def action(self, name: str | None, state: np.ndarray) -> np.ndarray:
        """Actions (T, n): as named, else ``torque``, else the state of the next sample."""
        if name is None and "torque" in self.columns:
            name = "torque"
        if name is None:
            return np.vstack([state[1:], state[-1:]])
        return self.columns[self.state([name])[0]]


def signals_of(items: Sequence[Item] | Item) -> list[Signals]:
    """Signals of demonstrations, or of trials, in the given order.

    A demonstration has ``data``, and for every frame j ``A_j``, ``b_j`` (row by row) and, where any
    frame did not see the data by Eq. (4), ``observation_j``.

    Raises
    ------
    ArgumentError
        There are none, or a trial has no time or arrays of other lengths.
    """
    if isinstance(items, Demonstration | Mapping):
        items = [items]
    own = any(isinstance(item, Demonstration) and _has_own_views(item) for item in items)
    found = [
        _of_demonstration(item, i, own) if isinstance(item, Demonstration) else _of_trial(item, i)
        for i, item in enumerate(items)
    ]
    if not found:
        raise ArgumentError("nothing to write; give at least one demonstration or trial")
    names = [list(signals.columns) for signals in found]
    for signals, other in zip(found, names, strict=True):
        widths = {n: v.shape[1] for n, v in signals.columns.items()}
        if other != names[0] or widths != {n: v.shape[1] for n, v in found[0].columns.items()}:
            raise ArgumentError(
                f"{signals.name} holds other signals than {found[0].name}; write them to two files"
            )
    return found


def _of_demonstration(demonstration: Demonstration, number: int, own: bool) -> Signals:
    T = len(demonstration)
    columns = {"data": demonstration.data}
    for j, frame in enumerate(demonstration.frames):
        columns[f"A_{j}"] = np.broadcast_to(frame.A, (T, *frame.A.shape[-2:])).reshape(T, -1)
        columns[f"b_{j}"] = np.broadcast_to(frame.b, (T, frame.b.shape[-1]))
    if own:
        columns |= {f"observation_{j}": o for j, o in enumerate(demonstration.observations)}
    return Signals(demonstration.name or f"demonstration {number}", demonstration.time, columns)


def _has_own_views(demonstration: Demonstration) -> bool:
    """Whether a frame saw something else than the data by Eq. (4)."""
    views = zip(demonstration.frames, demonstration.observations, strict=True)
    return not all(
        np.allclose(observation, frame.to_local(demonstration.data), rtol=1e-9, atol=1e-12)
        for frame, observation in views
    )


def _of_trial(trial: Mapping[str, Any], number: int) -> Signals:
    name = f"trial {number}"
    if "time" not in trial:
        raise ArgumentError(f"{name} has no array 'time'; it has {', '.join(map(str, trial))}")
    arrays = {key: np.asarray(value) for key, value in trial.items()}
    time = arrays.pop("time").astype(float)
    if time.ndim != 1 or not len(time) or not (np.diff(time) > 0).all():
        raise ArgumentError(f"{name}: time has shape {time.shape}; give (T,), strictly increasing")
    columns = {}
    for key, values in arrays.items():
        if values.dtype.kind not in "fiub" or not values.ndim or not values.size:
            continue
        if len(values) != len(time):
            raise ArgumentError(f"{name}: {key} has {len(values)} rows and time {len(time)}")
        columns[key] = values.reshape(len(time), -1).astype(float)
        bad = np.flatnonzero(~np.isfinite(columns[key]).all(1))
        if len(bad):
            raise ArgumentError(f"{name}: {key} is not a number in row {bad[0]}")
    if not columns:
        raise ArgumentError(f"{name} has no signals beside time")
    return Signals(name, time, columns)


def parts_of(name: str, width: int) -> list[str]:
    """Names of the single columns of a signal: ``q[0], q[1], ...``."""
    return [name] if width == 1 else [f"{name}[{i}]" for i in range(width)]
