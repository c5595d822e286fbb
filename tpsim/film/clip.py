"""What a film shows: recorded movements, and what is drawn over them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from tpsim.border import Positive, border, checked
from tpsim.errors import ArgumentError
from tpsim.world.trial import Trial
from tpsim.world.world import World


@dataclass(frozen=True)
class Arrow:
    """A force that is drawn as an arrow pushing at its point.

    Parameters
    ----------
    point : (T, 3)
        Where it acts, m.
    force : (T, 3)
        The force, N; nothing is drawn while it is zero.
    """

    point: np.ndarray
    force: np.ndarray

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Ellipsoid:
    """A stiffness that is drawn as an ellipsoid, long where it is stiff.

    Parameters
    ----------
    centre : (T, 3)
        Usually a hand, m.
    stiffness : (T, 3, 3)
        Translational stiffness, N/m; the semi-axes grow with the roots of its eigenvalues.
    """

    centre: np.ndarray
    stiffness: np.ndarray

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Reading:
    """A figure that is shown as it is measured.

    Parameters
    ----------
    name : str
        What it is, such as ``"cup tilt"``.
    values : (T,)
        Over the recording.
    unit : str
    limit : float, optional
        Above it the figure stands out.
    """

    name: str
    values: np.ndarray
    unit: str = ""
    limit: float | None = None

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True)
class Clip:
    """One sequence of a film: a recorded movement and what is drawn over it.

    Parameters
    ----------
    world : World
        What is there; the drawing processes are given its text and files.
    time : (T,)
        Increasing, s.
    q : (T, n)
        Positions of the robot's joints, rad.
    title, subtitle : str
        Caption; none without a title.
    arrows : tuple of Arrow
    traces : tuple of (T, 3)
        Paths of points, drawn up to the present, m.
    ellipsoids : tuple of Ellipsoid
    objects : mapping of str to (T, 3) or (T, 7)
        Position, or position and quaternion (w, x, y, z), of objects of the world.
    camera : str
        A camera of the world; without it the film's.
    readings : tuple of Reading
        Shown in the upper left corner.
    legend : tuple of str
        What each trace is; with it a legend says what arrows and ellipsoids are, to which scale.
    close : (T, 3), optional
        What a second camera looks at from near, in an inset [m].
    centre : (3,), optional
        Point [m] that the camera looks at from nearer than its place.
    speed : float
        Film time runs this many times faster than the recording.

    Raises
    ------
    ArgumentError
        If shapes do not fit the time or a value is not finite.
    """

    world: World
    time: np.ndarray
    q: np.ndarray
    title: str = ""
    subtitle: str = ""
    arrows: tuple[Arrow, ...] = ()
    traces: tuple[np.ndarray, ...] = ()
    ellipsoids: tuple[Ellipsoid, ...] = ()
    objects: Mapping[str, np.ndarray] = field(default_factory=dict)
    camera: str = ""
    speed: Positive = 1.0
    readings: tuple[Reading, ...] = ()
    legend: tuple[str, ...] = ()
    close: np.ndarray | None = None
    centre: np.ndarray | None = None

    @classmethod
    @border
    def of(
        cls,
        world: World,
        trial: Trial,
        title: str,
        subtitle: str = "",
        *,
        traces: tuple[np.ndarray, ...] = (),
        ellipsoids: tuple[Ellipsoid, ...] = (),
        camera: str = "",
        speed: float = 1.0,
    ) -> "Clip":
        """A recorded trial with its objects, and all forces of people as arrows."""
        arrows = tuple(
            Arrow(trial[f"{person}_point"], trial[f"{person}_wrench"][:, :3])
            for person in trial.channels.people
        )
        objects = {name: np.hstack(poses) for name, poses in trial.objects.items()}
        return cls(
            world,
            trial.time,
            trial["q"],
            title,
            subtitle,
            arrows,
            traces,
            ellipsoids,
            objects,
            camera,
            speed,
        )

    def __post_init__(self) -> None:
        checked(self)
        length = np.size(self.time)
        if np.ndim(self.time) != 1 or length == 0 or (np.diff(self.time) <= 0).any():
            raise ArgumentError("time of a clip: give one row of increasing seconds")
        tails: list[tuple[str, np.ndarray, tuple[tuple[int, ...], ...]]]
        tails = [("time", self.time, ((),)), ("q", self.q, (np.shape(self.q)[1:2],))]
        tails += [("trace", trace, ((3,),)) for trace in self.traces]
        for arrow in self.arrows:
            tails += [("point", arrow.point, ((3,),)), ("force", arrow.force, ((3,),))]
        for shape in self.ellipsoids:
            tails += [("centre", shape.centre, ((3,),)), ("stiffness", shape.stiffness, ((3, 3),))]
        tails += [(f"object {name}", p, ((3,), (7,))) for name, p in self.objects.items()]
        tails += [(reading.name, reading.values, ((),)) for reading in self.readings]
        if self.close is not None:
            tails.append(("close", self.close, ((3,),)))
        if self.centre is not None and np.shape(self.centre) != (3,):
            raise ArgumentError(f"centre has shape {np.shape(self.centre)}; give a point (3,)")
        for name, array, allowed in tails:
            if np.shape(array) not in [(length, *tail) for tail in allowed]:
                wanted = " or ".join(str((length, *tail)) for tail in allowed)
                raise ArgumentError(
                    f"{name} of a clip has shape {np.shape(array)}: give {wanted}, as its time"
                )
