"""Products of R^n, S1, S2 and S3: the manifold on which a movement lives."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import takewhile
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Part
from tpsim.arrays import LARGEST
from tpsim.checks import choice, dimensions, finite_array, instance, several
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.manifold.charts import Charts
from tpsim.manifold.frames import RIGID, check_columns, check_rigid
from tpsim.manifold.orientations import Rotations
from tpsim.manifold.spaces import Circle, Euclidean, Moves, Space
from tpsim.manifold.sphere import Sphere
from tpsim.manifold.unit import off_orthonormal


class Factors(NamedTuple):
    """Some columns of the points of a manifold: their own manifold, columns and tangent rows."""

    manifold: "Manifold"
    columns: np.ndarray
    rows: np.ndarray


@dataclass(frozen=True)
class Manifold(Part):
    """A product of factors: ``R(1, "inputs") * R(3) * S3`` is time, position and orientation.

    A point has the columns of its factors side by side: numbers, angles [rad], unit vectors
    (x, y, z), unit quaternions (w, x, y, z). A tangent vector has numbers, angles [rad], two
    angles across a direction, and a rotation vector [rad] aligned with the frame of reference.

    Parameters
    ----------
    spaces : tuple of Space
        Factors; ``R``, ``S1``, ``S2``, ``S3`` and ``*`` make manifolds of them.
    """

    spaces: tuple[Space, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "spaces", tuple(several("spaces", self.spaces, Space)))
        if not self.spaces:
            raise ArgumentError("spaces is empty; give at least one factor, such as R(3) or S3")

    def __mul__(self, other: "Manifold") -> "Manifold":
        """Product of two manifolds: points side by side."""
        return Manifold(self.spaces + instance("other", other, Manifold, "R(3) or S3").spaces)

    def __str__(self) -> str:
        return " * ".join(map(str, self.spaces))

    @cached_property
    def width(self) -> int:
        """Columns of a point."""
        return sum(space.width for space in self.spaces)

    @cached_property
    def dim(self) -> int:
        """Tangent coordinates."""
        return sum(space.dim for space in self.spaces)

    @cached_property
    def flat(self) -> bool:
        """Whether it is R^n as a whole."""
        return all(space.flat for space in self.spaces)

    def mirrored(self, axis: str) -> "Manifold":
        """The same for frames that are reflections: bodies are mirrored across this axis of theirs.

        Parameters
        ----------
        axis : str
            ``"x"``, ``"y"`` or ``"z"``.
        """
        choice("axis", axis, ("x", "y", "z"))
        return Manifold(
            tuple(Rotations(axis) if isinstance(s, Rotations) else s for s in self.spaces)
        )

    def part(self, name: str, columns: int | Sequence[int] | np.ndarray) -> "Factors":
        """Some columns of a point as a manifold of their own; curved factors as a whole.

        Parameters
        ----------
        name : str
            What messages call them.
        columns : int or sequence of int
        """
        chosen = dimensions(name, columns, self.width).tolist()
        spaces: list[Space] = []
        rows: list[int] = []
        place = 0
        while place < len(chosen):
            block = next(b for b in self.work.single if chosen[place] < b.columns.stop)
            space, whole, local = block
            if isinstance(space, Euclidean):
                inside = range(whole.start, whole.stop)
                taken = list(takewhile(inside.__contains__, chosen[place:]))
                spaces.append(Euclidean(len(taken), space.moves))
                rows += [local.start + column - whole.start for column in taken]
                place += len(taken)
                continue
            own = list(range(whole.start, whole.stop))
            if chosen[place : place + len(own)] != own:
                raise ArgumentError(
                    f"{name} takes columns {chosen} of {self}; give those of {space}, {own}, "
                    "together or not at all"
                )
            spaces.append(space)
            rows += range(local.start, local.stop)
            place += len(own)
        return Factors(Manifold(tuple(spaces)), np.array(chosen), np.array(rows))

    @cached_property
    def work(self) -> Charts:
        """The same maps unchecked, for points that are known to be some."""
        return Charts(self.spaces)

    def log(self, x: ArrayLike, y: ArrayLike) -> np.ndarray:
        """Tangent vectors (..., dim) at x that lead to y, along the shortest way.

        Parameters
        ----------
        x, y : (..., width)
            Points; leading axes broadcast.
        """
        return self.work.log(*self._pair(self.points("x", x), self.points("y", y)))

    def exp(self, x: ArrayLike, v: ArrayLike) -> np.ndarray:
        """Points (..., width) to which tangent vectors at x lead.

        Parameters
        ----------
        x : (..., width)
        v : (..., dim)
        """
        v = finite_array("v", v)
        if v.shape[-1:] != (self.dim,) or (v.size and not np.abs(v).max() < LARGEST):
            raise ArgumentError(
                f"v has shape {v.shape}; {self} has {self.dim} tangent coordinates, each below "
                f"{LARGEST:.0e}"
            )
        return self.work.exp(*self._pair(self.points("x", x), v))

    def transport(self, x: ArrayLike, y: ArrayLike) -> np.ndarray:
        """Parallel transport (..., dim, dim) of tangent coordinates at x to those at y.

        Parameters
        ----------
        x, y : (..., width)
        """
        return self.work.transport(*self._pair(self.points("x", x), self.points("y", y)))

    def distance(self, x: ArrayLike, y: ArrayLike) -> np.ndarray:
        """Length (...) of the shortest way from x to y, all units alike.

        Parameters
        ----------
        x, y : (..., width)
        """
        v = self.log(x, y)
        return np.sqrt(np.vecdot(v, v))

    def _pair(self, x: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        try:
            np.broadcast_shapes(x.shape[:-1], other.shape[:-1])
        except ValueError:
            raise ArgumentError(
                f"x has leading axes {x.shape[:-1]}, the other {other.shape[:-1]}; they must "
                "broadcast, as in x[..., None, :]"
            ) from None
        return x, other

    def points(self, name: str, y: ArrayLike) -> np.ndarray:
        """Points (..., width) brought onto the manifold: unit lengths, angles within half a turn.

        Raises
        ------
        ArgumentError
            Another number of columns, NaN, or quaternions and directions of zero length.
        """
        y = finite_array(name, y)
        if y.shape[-1:] != (self.width,):
            raise ArgumentError(
                f"{name} has shape {y.shape}; {self} has {self.width} columns in the last axis"
            )
        if self.flat:
            return y
        found = y.copy()
        for space, columns, _ in self.work.blocks:
            if not space.flat:
                found[..., columns] = space.valid(name, y[..., columns])
        return found

    @cached_property
    def _lone(self) -> bool:
        """Whether it is one factor of as many columns as a frame's axes, to which b is nothing."""
        (first, *others) = self.spaces
        moved = isinstance(first, Euclidean) and first.moves != "points"
        return not others and (moved or isinstance(first, Sphere))

    def frame(self, frame: Frame) -> Frame:
        """What a rigid motion of the plane or of space, Eq. (4), does to the columns of a point.

        Points become A x + b, vectors A x, directions A n, angles are turned by the heading of A,
        orientations are turned by A; what frames leave alone stays. A reflection mirrors
        directions and angles; orientations where :meth:`mirrored` says how.

        Parameters
        ----------
        frame : Frame
            A (..., n, n), b (..., n), n = 2 or 3; or of the columns already, A (..., w, w), with
            left multiplications for quaternions, which is checked.
        """
        frame = instance("frame", frame, Frame, "give Frame(A, b)")
        if self._of_columns(frame):
            return check_columns(self.work, frame)
        A, b = frame.A, frame.b
        check_rigid(self.work, A)
        parts = [space.lifted(A, b) for space in self.spaces]
        lead = A.shape[:-2]
        whole, offset = np.zeros((*lead, self.width, self.width)), np.zeros((*lead, self.width))
        for (_, columns, _), (turn, move) in zip(self.work.single, parts, strict=True):
            whole[..., columns, columns], offset[..., columns] = turn, move
        return Frame.trusted(whole, offset)

    def moved(self, frame: Frame, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
        """Images (..., width) of points under a frame, see :meth:`frame`, and tangent maps.

        The latter (..., dim, dim) lead from points to images; and whether they keep lengths.
        """
        if self._of_columns(frame):
            A = check_columns(self.work, frame).A
            y = np.matmul(A, x[..., None])[..., 0] + frame.b
            return y, self.work.turned(A, x, y), off_orthonormal(A) < RIGID
        off = check_rigid(self.work, frame.A)
        return *self.work.moved(frame.A, frame.b, x), off < RIGID

    def _of_columns(self, frame: Frame) -> bool:
        return frame.A.shape[-1] == self.width and not self._lone


def R(n: int, moves: Moves = "points") -> Manifold:
    """R^n: n numbers, as a manifold.

    Parameters
    ----------
    n : int
    moves : str
        What frames of reference do to it: to ``"points"`` A x + b, to ``"vectors"``, such as
        velocities, A x, and to ``"inputs"``, such as time, nothing.
    """
    return Manifold((Euclidean(n, moves),))


S1 = Manifold((Circle(),))
"""The circle: angles [rad], of which whole turns do not count."""

S2 = Manifold((Sphere(),))
"""The sphere: directions in space, unit vectors."""

S3 = Manifold((Rotations(),))
"""Orientations: unit quaternions (w, x, y, z), q and -q the same."""
