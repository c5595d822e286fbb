"""What a file does not say: which columns are time, position, orientation, joints and frames."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

from tpsim.border import Positive, border, checked
from tpsim.checks import shown
from tpsim.data.units import ANGLE, LENGTH, TIME
from tpsim.errors import ArgumentError

Name = str | int
"""A column: its name, its number from 0, a name of several (``"q"`` for ``q_0, q_1, ...``), or a
pattern with ``*`` and ``?``."""

Names = Name | Sequence[Name]

_MOVEMENT = ("position", "orientation", "joints", "other")


@dataclass(frozen=True)
class PoseColumns:
    """Where a file holds the pose of an object.

    Parameters
    ----------
    name : str
        Of the object.
    position : column names
        3 columns, or 2 in the plane [``Columns.length_unit``].
    orientation : column names
        As many as ``order`` asks for; none where the object is a point.
    order : str
        As :attr:`Columns.order`; also ``"angle"`` in the plane.
    moving : bool
        A frame at every sample; otherwise one constant frame, from the first sample.
    """

    name: str = ""
    position: Names = ()
    orientation: Names = ()
    order: str = "wxyz"
    moving: bool = False

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Columns:
    """Description of a file's columns. What is left None the file or its format must say.

    Parameters
    ----------
    time : column name
        Stamps; default a column with a usual name, such as ``time`` or ``timestamp``.
    rate : float
        Samples per second [Hz], where there are no stamps.
    time_unit : "s", "ms", "us", "ns" or "min"
    position : column names
        3 columns, or 2 in the plane.
    orientation : column names
    order : str
        Of the orientation's columns: ``"wxyz"`` or ``"xyzw"`` quaternions, ``"rotvec"``,
        ``"matrix"`` (9 columns, row by row), ``"pose"`` (16 columns of a 4 x 4 matrix, column by
        column as libfranka writes it), or scipy's names of Euler angles, such as ``"xyz"``.
    joints : column names
    other : column names
        Taken as they are, behind position, orientation and joints.
    length_unit : "m", "cm" or "mm"
        Of all positions.
    angle_unit : "rad" or "deg"
        Of joints, Euler angles and rotation vectors.
    frames : sequence of str or PoseColumns
        Objects to see the movement from. A name is looked up among the poses of the file:
        ``"box"`` is found as ``box_x, box_y, box_z, box_qw, ...``, as a topic, or as a transform.
        ``"start"`` and ``"end"`` are the movement's own first and last sample.
    moving : bool
        Whether frames that are given by name move.
    demonstration : column name
        Where one file holds several demonstrations: the column that numbers them.
    bad_rows : "refuse" or "drop"
        What to do with rows that hold NaN, a quaternion of zero length, or a stamp that does not
        increase.

    Raises
    ------
    ArgumentError
        An unknown unit, or a rate that is not positive.
    """

    time: Name | None = None
    rate: Positive | None = None
    time_unit: str | None = None
    position: Names | None = None
    orientation: Names | None = None
    order: str | None = None
    joints: Names | None = None
    other: Names | None = None
    length_unit: str | None = None
    angle_unit: str | None = None
    frames: Sequence[str | PoseColumns] | None = None
    moving: bool = False
    demonstration: Name | None = None
    bad_rows: Literal["refuse", "drop"] = "refuse"

    def __post_init__(self) -> None:
        checked(self)
        for field, known in (("time_unit", TIME), ("length_unit", LENGTH), ("angle_unit", ANGLE)):
            unit = getattr(self, field)
            if unit is not None and unit not in known:
                raise ArgumentError(f"{field} is {shown(unit)}; give one of {', '.join(known)}")

    @property
    def says_movement(self) -> bool:
        """Whether it names the columns of the movement."""
        return any(getattr(self, name) is not None for name in _MOVEMENT)

    @border
    def over(self, defaults: "Columns") -> "Columns":
        """Fill what is left open here with ``defaults``."""
        open_fields = {
            field.name: getattr(defaults, field.name)
            for field in fields(self)
            if getattr(self, field.name) is None
            and not (field.name in (*_MOVEMENT, "order") and self.says_movement)
            and not (field.name == "time" and self.rate is not None)
            and not (field.name == "rate" and self.time is not None)
        }
        return replace(self, **open_fields)


def listed(names: Names | None) -> list[Name]:
    """Return names as a list, whether one or several were given."""
    if names is None:
        return []
    return [names] if isinstance(names, str | int) else list(names)
