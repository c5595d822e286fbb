"""The robot's mechanism as arrays, exact to the bit, and back: no simulator is needed to read."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from tpsim.errors import ArgumentError
from tpsim.robot.mechanism import Mechanism

_HINGE = "JointModelRevoluteUnaligned"
_MOTIONS = {True: pin.JointModelRevoluteUnaligned, False: pin.JointModelPrismaticUnaligned}


@dataclass(frozen=True, eq=False)
class RobotFile:
    """A mechanism of n joints; link i moves with joint i, link -1 is the world.

    Parameters
    ----------
    joints : tuple of str
        Parents come before their children.
    parents : tuple of int
        Joint that carries each joint; -1 for the world.
    hinges : tuple of bool
        Whether a joint turns; else it slides.
    axes : (n, 3)
    placements : (n, 3, 4)
        Rotation and position [m] of each joint in its parent.
    masses, centres, inertias : (n,), (n, 3), (n, 3, 3)
        Of each link in its joint [kg], [m], [kg m^2].
    armature, damping, friction, springs, slack, home : (n,)
    lower, upper, velocity_limit, torque_limit : (n,)
    gravity : (3,)
        [m/s^2]
    hands : dict of str to str
    sites, carriers : tuple of str, tuple of int
        Sites, and the joint that carries each.
    site_placements : (k, 3, 4)
    """

    joints: tuple[str, ...]
    parents: tuple[int, ...]
    hinges: tuple[bool, ...]
    axes: np.ndarray
    placements: np.ndarray
    masses: np.ndarray
    centres: np.ndarray
    inertias: np.ndarray
    armature: np.ndarray
    damping: np.ndarray
    friction: np.ndarray
    springs: np.ndarray
    slack: np.ndarray
    home: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    velocity_limit: np.ndarray
    torque_limit: np.ndarray
    gravity: np.ndarray
    hands: dict[str, str]
    sites: tuple[str, ...]
    carriers: tuple[int, ...]
    site_placements: np.ndarray

    def __post_init__(self) -> None:
        n, k = len(self.joints), len(self.sites)
        shapes = {"axes": (n, 3), "placements": (n, 3, 4), "masses": (n,), "centres": (n, 3)}
        shapes |= {"inertias": (n, 3, 3), "gravity": (3,), "site_placements": (k, 3, 4)}
        shapes |= dict.fromkeys(
            ("armature", "damping", "friction", "springs", "slack", "home"), (n,)
        )
        shapes |= dict.fromkeys(("lower", "upper", "velocity_limit", "torque_limit"), (n,))
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ArgumentError(f"{name} has shape {getattr(self, name).shape}, not {shape}")
            # Only limits may be infinite: there are joints without any.
            bounded = name not in ("lower", "upper", "velocity_limit", "torque_limit")
            if bounded and not np.isfinite(getattr(self, name)).all():
                raise ArgumentError(f"{name} is not finite")
        ordered = all(-1 <= parent < i for i, parent in enumerate(self.parents))
        counts = len(self.parents) == len(self.hinges) == n and len(self.carriers) == k
        if not (n and ordered and counts and all(-1 <= c < n for c in self.carriers)):
            raise ArgumentError("its joints and sites do not form a tree")
        if unknown := sorted(set(self.hands.values()) - set(self.sites)):
            raise ArgumentError(f"the hands' sites {unknown} are missing")

    @classmethod
    def of(cls, robot: Mechanism) -> "RobotFile":
        """A mechanism's arrays."""
        model, moving = robot.model, range(1, robot.model.njoints)
        frames = [model.frames[frame] for frame in robot.sites.values()]
        links = [model.inertias[i] for i in moving]
        return cls(
            robot.joints,
            tuple(int(model.parents[i]) - 1 for i in moving),
            tuple(model.joints[i].shortname() == _HINGE for i in moving),
            np.array([model.joints[i].extract().axis for i in moving]),
            np.array([model.jointPlacements[i].homogeneous[:3] for i in moving]),
            np.array([link.mass for link in links]),
            np.array([link.lever for link in links]),
            np.array([link.inertia for link in links]),
            np.array(model.armature),
            *(robot.damping, robot.friction, robot.springs, robot.slack, robot.home),
            *(robot.lower, robot.upper, robot.velocity_limit, robot.torque_limit),
            np.array(model.gravity.linear),
            dict(robot.hands),
            tuple(robot.sites),
            tuple(int(frame.parentJoint) - 1 for frame in frames),
            np.array([frame.placement.homogeneous[:3] for frame in frames]).reshape(-1, 3, 4),
        )

    def mechanism(self) -> Mechanism:
        """The mechanism of these arrays."""
        model = pin.Model()
        model.gravity.linear = self.gravity
        for i, joint in enumerate(self.joints):
            motion = _MOTIONS[self.hinges[i]](self.axes[i])
            model.addJoint(self.parents[i] + 1, motion, _se3(self.placements[i]), joint)
            model.inertias[i + 1] = pin.Inertia(
                float(self.masses[i]), self.centres[i], self.inertias[i]
            )
        model.armature = self.armature
        sites = {}
        for name, carrier, at in zip(self.sites, self.carriers, self.site_placements, strict=True):
            frame = pin.Frame(f"site:{name}", carrier + 1, _se3(at), pin.FrameType.OP_FRAME)
            # Without the frame's own inertia: adding nothing would round the link's.
            sites[name] = model.addFrame(frame, False)
        return Mechanism(
            *(model, sites, self.joints, dict(self.hands)),
            *(self.lower, self.upper, self.velocity_limit, self.torque_limit),
            *(self.home, self.damping, self.friction, self.springs, self.slack),
        )


def _se3(placement: np.ndarray) -> pin.SE3:
    return pin.SE3(placement[:, :3].copy(), placement[:, 3].copy())
