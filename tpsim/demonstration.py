"""One demonstration: a movement, the frames of reference around it, and what they saw."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import load_arrays, save_arrays
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import finite_array


@dataclass(frozen=True, eq=False)
class Demonstration:
    """A movement seen from several frames of reference.

    Parameters
    ----------
    time : (T,)
        Strictly increasing [s].
    data : (T, D)
        The movement in common coordinates.
    frames : sequence of P Frame
        Constant, or moving with leading axis T.
    observations : sequence of P arrays (T, d_j), optional
        What each frame saw; default ``frame.to_local(data)``, Eq. (4).
    name : str

    Raises
    ------
    ArgumentError
        No samples, NaN, a time that stands still, or shapes that do not fit together.
    """

    time: np.ndarray
    data: np.ndarray
    frames: tuple[Frame, ...] = ()
    observations: tuple[np.ndarray, ...] | None = None
    name: str = ""

    def __post_init__(self):
        time, data = finite_array("time", self.time), finite_array("data", self.data)
        frames = tuple(self.frames)
        _check(time, data, frames)
        if self.observations is None:
            observations = tuple(frame.to_local(data) for frame in frames)
        else:
            observations = tuple(finite_array("observations", o) for o in self.observations)
            _check_observations(observations, frames, len(time))
        for name, value in (
            ("time", time),
            ("data", data),
            ("frames", frames),
            ("observations", observations),
            ("name", str(self.name)),
        ):
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        return len(self.time)

    def resampled(self, times: int | ArrayLike, *, smooth: bool = False) -> "Demonstration":
        """Movement at other times.

        Parameters
        ----------
        times : int or (S,)
            A number of equally spaced samples, or the times themselves [s], inside the
            demonstration's own span.
        smooth : bool
            Cubic spline instead of straight lines between samples (needs T >= 4).

        Raises
        ------
        ArgumentError
            Times outside the span, or fewer than one sample.

        Notes
        -----
        Every column is interpolated for itself. A moving frame that is a rotation is brought
        back to the nearest rotation.
        """
        times = self._new_times(times)

        def at(values: np.ndarray) -> np.ndarray:
            return _interpolate(self.time, values, times, smooth)

        frames = tuple(_resample_frame(frame, at) for frame in self.frames)
        observations = tuple(at(o) for o in self.observations)
        return Demonstration(times, at(self.data), frames, observations, self.name)

    def with_time(self, input: ArrayLike | None = None) -> "Demonstration":
        """Put an input in front of the data and of every frame's view, Eq. (20).

        Parameters
        ----------
        input : (T,) or (T, I), optional
            Default the time since the start of the movement [s].
        """
        given = self.time - self.time[0] if input is None else finite_array("input", input)
        columns = given.reshape(len(given), -1) if given.ndim else given
        if columns.shape[:1] != self.time.shape:
            raise ArgumentError(
                f"input has shape {given.shape}; it needs one row per sample, T = {len(self)}"
            )
        n = columns.shape[1]
        return Demonstration(
            self.time,
            np.hstack([columns, self.data]),
            tuple(frame.with_input(n) for frame in self.frames),
            tuple(np.hstack([columns, o]) for o in self.observations),
            self.name,
        )

    def with_derivatives(self, n: int = 2) -> "Demonstration":
        """Append ``n`` derivatives to the data and to every frame's view, Eqs (21-22) and (32).

        Forward differences; the movement is taken to rest after its last sample, so the last
        derivative is zero.
        """
        return Demonstration(
            self.time,
            _differentiate(self.time, self.data, n),
            tuple(frame.with_derivatives(n) for frame in self.frames),
            tuple(_differentiate(self.time, o, n) for o in self.observations),
            self.name,
        )

    def save(self, path: str | Path) -> Path:
        """Write to an .npz archive, whole or not at all, without pickles."""
        arrays = {"time": self.time, "data": self.data, "name": np.array(self.name)}
        for j, (frame, observation) in enumerate(zip(self.frames, self.observations, strict=True)):
            arrays |= {f"A_{j}": frame.A, f"b_{j}": frame.b, f"observation_{j}": observation}
        return save_arrays(path, "demonstration", arrays)

    @classmethod
    def load(cls, path: str | Path) -> "Demonstration":
        """Read what :meth:`save` wrote; RecordingError where the file is something else."""
        arrays = load_arrays(path, "demonstration")
        count = sum(name.startswith("A_") for name in arrays)
        return cls(
            arrays["time"],
            arrays["data"],
            tuple(Frame(arrays[f"A_{j}"], arrays[f"b_{j}"]) for j in range(count)),
            tuple(arrays[f"observation_{j}"] for j in range(count)),
            str(arrays["name"]),
        )

    def _new_times(self, times: int | ArrayLike) -> np.ndarray:
        first, last = self.time[0], self.time[-1]
        if np.ndim(times) == 0:
            if times < 1 or times != int(times):
                raise ArgumentError(f"times is {times}; ask for a whole number of samples >= 1")
            return np.linspace(first, last, int(times))
        times = finite_array("times", times)
        if times.size == 0 or times.min() < first or times.max() > last:
            raise ArgumentError(
                f"times must be inside the demonstration, {first} to {last} s, and not empty"
            )
        return times


def _check(time: np.ndarray, data: np.ndarray, frames: Sequence[Frame]) -> None:
    T = len(time) if time.ndim == 1 else 0
    if T == 0 or data.ndim != 2 or len(data) != T or data.shape[1] == 0:
        raise ArgumentError(
            f"time has shape {time.shape} and data {data.shape}; they must be (T,) and (T, D) "
            "with T >= 1 and D >= 1"
        )
    if (np.diff(time) <= 0).any():
        raise ArgumentError("time must increase strictly from sample to sample")
    for j, frame in enumerate(frames):
        if not isinstance(frame, Frame):
            raise ArgumentError(f"frame {j} is a {type(frame).__name__}; give a Frame(A, b)")
        if frame.dim != data.shape[1] or frame.shape not in ((), (T,)):
            raise ArgumentError(
                f"frame {j} has A of shape {frame.A.shape}; with this data it must be "
                f"({data.shape[1]}, d) or ({T}, {data.shape[1]}, d)"
            )


def _check_observations(observations: Sequence, frames: Sequence[Frame], T: int) -> None:
    given = [o.shape for o in observations]
    # Observations may come without the frames that would carry them to common coordinates.
    expected = [(T, frame.local_dim) for frame in frames] or [(T, *s[1:2]) for s in given]
    if given != expected:
        raise ArgumentError(f"observations have shapes {given}; the frames ask for {expected}")


def _interpolate(
    time: np.ndarray, values: np.ndarray, times: np.ndarray, smooth: bool
) -> np.ndarray:
    if len(time) == 1:
        return np.repeat(values, len(times), axis=0)
    if smooth:
        if len(time) < 4:
            raise ArgumentError(f"a cubic spline needs 4 samples, {len(time)} were given")
        from scipy.interpolate import CubicSpline

        return CubicSpline(time, values)(times)
    after = np.clip(np.searchsorted(time, times), 1, len(time) - 1)
    before = after - 1
    share = (times - time[before]) / (time[after] - time[before])
    share = share.reshape(-1, *(1,) * (values.ndim - 1))
    return (1 - share) * values[before] + share * values[after]


def _resample_frame(frame: Frame, at) -> Frame:
    if not frame.shape:
        return frame
    A = at(frame.A)
    if _orthonormal(frame.A):
        U, _, Vt = np.linalg.svd(A, full_matrices=False)
        A = U @ Vt
    return Frame(A, at(frame.b))


def _orthonormal(A: np.ndarray) -> bool:
    return bool(np.allclose(A.mT @ A, np.eye(A.shape[-1]), atol=1e-6))


def _differentiate(time: np.ndarray, values: np.ndarray, n: int) -> np.ndarray:
    """Stack values and ``n`` forward differences, Eqs (21-22)."""
    columns = [values]
    for _ in range(n):
        last = columns[-1]
        difference = np.zeros_like(last)
        difference[:-1] = np.diff(last, axis=0) / np.diff(time)[:, None]
        columns.append(difference)
    return np.hstack(columns)
