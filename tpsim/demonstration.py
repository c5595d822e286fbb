"""One demonstration: a movement, the frames of reference around it, and what they saw."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from tpsim import rotation
from tpsim.agreement import warn_of_jumps
from tpsim.archive import Stored
from tpsim.checks import (
    affordable,
    entries,
    finite_array,
    flag,
    frozen,
    frozen_array,
    several,
    shown,
    stamps,
    whole,
)
from tpsim.errors import ArgumentError
from tpsim.frame import Frame, as_before
from tpsim.timeline import differentiate, interpolate, new_times


@dataclass(frozen=True, eq=False, init=False)
class Demonstration(Stored):
    """A movement seen from several frames of reference.

    Parameters
    ----------
    time : (T,)
        Strictly increasing [s]. Durations (timedelta) are converted by their unit, dates
        (datetime) to seconds since the first sample.
    data : (T, D)
        The movement in common coordinates.
    frames : Frame, or sequence of P Frame, optional
        Constant, or moving with leading axis T.
    observations : sequence of P arrays (T, d_j), optional
        What each frame saw; default ``frame.to_local(data)``, Eq. (4). Without frames they are
        views of any kind, which a model can learn but which nothing can adapt.
    name : str
        Shown in error messages.

    Everything is copied, and read-only from then on.

    Raises
    ------
    ArgumentError
        No samples, NaN, a time that stands still, or shapes that do not fit together; with the
        first row that is wrong.
    """

    time: np.ndarray
    data: np.ndarray
    frames: tuple[Frame, ...]
    observations: tuple[np.ndarray, ...]
    name: str

    def __init__(
        self,
        time: ArrayLike,
        data: ArrayLike,
        frames: Sequence[Frame] | Frame | None = (),
        observations: Sequence[ArrayLike] | None = None,
        name: str = "",
    ):
        name = name if isinstance(name, str) else shown(name)
        label = f"demonstration {name!r}: " if name else ""
        times = frozen(np.array(stamps(f"{label}time", time)))
        values = frozen_array(f"{label}data", data)
        given = several(f"{label}frames", () if frames is None else frames, Frame, "Frame(A, b)")
        _check(label, times, values, given)
        if observations is None:
            seen = tuple(frozen(frame.to_local(values)) for frame in given)
        else:
            seen = tuple(
                frozen_array(f"{label}observations[{j}]", view)
                for j, view in enumerate(entries("observations", observations))
            )
            _check_observations(label, seen, given, len(times))
        for field, value in (
            ("time", times),
            ("data", values),
            ("frames", tuple(given)),
            ("observations", seen),
            ("name", name),
        ):
            object.__setattr__(self, field, value)

    @classmethod
    def from_poses(
        cls,
        time: ArrayLike,
        positions: ArrayLike,
        orientations: ArrayLike,
        convention: str = "wxyz",
        *,
        degrees: bool = False,
        frames: Sequence[Frame] | Frame | None = (),
        observations: Sequence[ArrayLike] | None = None,
        name: str = "",
    ) -> "Demonstration":
        """Movement of a body: columns x, y, z [m] and a unit quaternion w, x, y, z.

        Parameters
        ----------
        time : (T,)
            As in the class.
        positions : (T, 3)
            [m].
        orientations : (T, 4), (T, 3, 3), (T, 3) or (T,)
            As ``convention`` says.
        convention : str
            Quaternions ``"wxyz"`` or ``"xyzw"``, ``"matrix"`` for rotation matrices, or Euler
            angles by scipy's names: ``"xyz"`` about fixed axes, ``"ZYX"`` about turning ones.
        degrees : bool
            Euler angles are in degrees.
        frames, observations, name
            As in the class; frames have D = 7.

        Raises
        ------
        ArgumentError
            An unknown convention, quaternions that are not of unit length, or matrices that are
            no rotations, with their first row.

        Notes
        -----
        Quaternions keep their sign from sample to sample, beginning with w >= 0;
        :func:`tpsim.agree` brings several demonstrations to one sign. A DataWarning names the
        first place where neighbours are more than 60 degrees apart.
        """
        name = name if isinstance(name, str) else shown(name)
        label = f"demonstration {name!r}: " if name else ""
        positions = finite_array(f"{label}positions", positions)
        if positions.ndim != 2 or positions.shape[1] != 3:
            raise ArgumentError(f"{label}positions have shape {positions.shape}; give (T, 3)")
        degrees = flag("degrees", degrees)
        q = rotation.quaternions(f"{label}orientations", orientations, convention, degrees)
        if len(q) != len(positions):
            raise ArgumentError(f"{label}{len(positions)} positions and {len(q)} orientations")
        q = rotation.continuous(q if q[0, 0] >= 0 else -q)
        rotation.warn_of_turns(f"{label}orientations", q)
        return cls(time, np.hstack([positions, q]), frames, observations, name)

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
        times, smooth = new_times(self.time, times), flag("smooth", smooth)

        def at(values: np.ndarray) -> np.ndarray:
            return interpolate(self.time, values, times, smooth)

        frames = [_resampled(frame, at) for frame in self.frames]
        return Demonstration(
            times, at(self.data), frames, [at(view) for view in self.observations], self.name
        )

    def seen_from(self, frames: Sequence[int]) -> "Demonstration":
        """The same movement, seen from some of its frames only, in this order.

        Parameters
        ----------
        frames : sequence of int
            Such as those that :func:`tpsim.redundant_frames` keeps.
        """
        P = len(self.observations)
        kept = [whole("frame", j) for j in entries("frames", frames)]
        if not kept or max(kept) >= P:
            raise ArgumentError(
                f"there is no frame {max(kept, default='given')}; the demonstration has frames 0 "
                f"to {P - 1}: give one of them, or more"
            )
        return Demonstration(
            self.time,
            self.data,
            [self.frames[j] for j in kept] if self.frames else (),
            [self.observations[j] for j in kept],
            self.name,
        )

    def with_time(self, input: ArrayLike | None = None) -> "Demonstration":
        """Put an input in front of the data and of every frame's view, Eq. (20).

        Parameters
        ----------
        input : (T,) or (T, I), optional
            Default the time since the start of the movement [s].
        """
        given = self.time - self.time[0] if input is None else finite_array("input", input)
        if given.shape[:1] != self.time.shape or given.size == 0:
            raise ArgumentError(
                f"input has shape {given.shape}; it needs one row per sample, T = {len(self)}"
            )
        columns = given.reshape(len(given), -1)
        n = columns.shape[1]
        return Demonstration(
            self.time,
            np.hstack([columns, self.data]),
            [frame.with_input(n) for frame in self.frames],
            [np.hstack([columns, view]) for view in self.observations],
            self.name,
        )

    def with_derivatives(self, n: int = 2) -> "Demonstration":
        """Append ``n`` derivatives to the data and to every frame's view, Eqs (21-22) and (32).

        Forward divided differences, exact for polynomials of degree n at any spacing of the
        stamps; the movement is taken to rest after its last sample, so the last derivative is
        zero.
        """
        n = affordable("n", n, self.data.size, least=0)
        warn_of_jumps(self.data, self.name)
        extended = partial(differentiate, self.time, n=n)
        return Demonstration(
            self.time,
            extended(self.data),
            [frame.with_derivatives(n) for frame in self.frames],
            [extended(view) for view in self.observations],
            self.name,
        )


def _check(label: str, time: np.ndarray, data: np.ndarray, frames: Sequence[Frame]) -> None:
    T = len(time)
    if data.ndim != 2 or len(data) != T or data.shape[1] == 0:
        raise ArgumentError(
            f"{label}time has shape {time.shape} and data {data.shape}; they must be (T,) and "
            "(T, D) with T >= 1 and D >= 1"
        )
    for j, frame in enumerate(frames):
        if frame.dim != data.shape[1] or frame.shape not in ((), (T,)):
            raise ArgumentError(
                f"{label}frame {j} has A of shape {frame.A.shape}; with this data it must be "
                f"({data.shape[1]}, d) or ({T}, {data.shape[1]}, d)"
            )


def _check_observations(
    label: str, observations: Sequence[np.ndarray], frames: Sequence[Frame], T: int
) -> None:
    given = [view.shape for view in observations]
    if frames:
        expected = [(T, frame.local_dim) for frame in frames]
        fits, asked = given == expected, f"the frames ask for {expected}"
    else:
        fits = all(len(shape) == 2 and shape[0] == T and shape[1] for shape in given)
        asked = f"each must be ({T}, d_j)"
    if not fits:
        raise ArgumentError(f"{label}observations have shapes {given}; {asked}")


def _resampled(frame: Frame, at) -> Frame:
    if not frame.shape:
        return frame
    return Frame.trusted(as_before(at(frame.A), frame.A), at(frame.b))
