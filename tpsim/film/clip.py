"""What a film shows: recorded movements, and what is drawn over them."""

from dataclasses import dataclass, field

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.sim.trial import Trial


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


@dataclass(frozen=True)
class Clip:
    """One sequence of a film: a recorded movement and what is drawn over it.

    Parameters
    ----------
    scene : str
        MJCF text.
    time : (T,)
        Increasing, s.
    q : (T, n)
        Joint positions in the order of the scene, rad.
    title, subtitle : str
        Caption; none without a title.
    arrows : tuple of Arrow
    traces : tuple of (T, 3)
        Paths of points, drawn up to the present, m.
    ellipsoids : tuple of Ellipsoid
    objects : dict of str to (T, 3) or (T, 7)
        Position, or position and quaternion (w, x, y, z), of mocap bodies of the scene.
    camera : str
        A camera of the scene; without it the film's.
    speed : float
        Film time runs this many times faster than the recording.

    Raises
    ------
    ArgumentError
        If shapes do not fit the time or a value is not finite.
    """

    scene: str
    time: np.ndarray
    q: np.ndarray
    title: str = ""
    subtitle: str = ""
    arrows: tuple[Arrow, ...] = ()
    traces: tuple[np.ndarray, ...] = ()
    ellipsoids: tuple[Ellipsoid, ...] = ()
    objects: dict[str, np.ndarray] = field(default_factory=dict)
    camera: str = ""
    speed: float = 1.0

    @classmethod
    def of(cls, scene: str, trial: Trial, title: str, subtitle: str, objects=(), **drawn) -> "Clip":
        """A recorded trial with all forces of people as arrows.

        Parameters
        ----------
        scene : str
            MJCF text.
        trial : Trial
        title, subtitle : str
            Caption.
        objects : iterable of str
            Names of recorded objects that move.
        **drawn
            Other fields of the clip.
        """
        arrows = tuple(
            Arrow(trial[name.replace("_wrench", "_point")], wrench[:, :3])
            for name, wrench in trial.arrays.items()
            if name.endswith("_wrench")
        )
        poses = {
            name: np.hstack([trial[f"{name}_position"], trial[f"{name}_quaternion"]])
            for name in objects
        }
        clock, q = trial["time"], trial["q"]
        return cls(scene, clock, q, title, subtitle, arrows, objects=poses, **drawn)

    def __post_init__(self):
        length = np.size(self.time)
        if np.ndim(self.time) != 1 or length == 0 or (np.diff(self.time) <= 0).any():
            raise ArgumentError("time of a clip: give one row of increasing seconds")
        if not self.speed > 0:
            raise ArgumentError(f"speed {self.speed} of a clip: give a positive number")
        tails = [("time", self.time, ((),)), ("q", self.q, ((np.shape(self.q)[-1],),))]
        tails += [("trace", trace, ((3,),)) for trace in self.traces]
        for arrow in self.arrows:
            tails += [("point", arrow.point, ((3,),)), ("force", arrow.force, ((3,),))]
        for shape in self.ellipsoids:
            tails += [("centre", shape.centre, ((3,),)), ("stiffness", shape.stiffness, ((3, 3),))]
        tails += [(name, pose, ((3,), (7,))) for name, pose in self.objects.items()]
        for name, array, allowed in tails:
            if np.shape(array) not in [(length, *tail) for tail in allowed]:
                wanted = " or ".join(str((length, *tail)) for tail in allowed)
                raise ArgumentError(
                    f"{name} of a clip has shape {np.shape(array)}: give {wanted}, as its time"
                )
            if not np.isfinite(array).all():
                raise ArgumentError(f"{name} of a clip has values that are not finite")
