"""A person's grip that leads the robot: a capped spring and damper on a site."""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
import pinocchio as pin

from tpsim.border import NotNegative, Positive, Strength, border, checked
from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.robot.state import State
from tpsim.world.people.care import EVERYTHING, Care
from tpsim.world.people.sight import Correction, Moving, Sight, Watched
from tpsim.world.simulation import Simulation


@dataclass(frozen=True)
class HandPath:
    """Where a person wants the held site to be, sampled on the simulation's clock.

    Parameters
    ----------
    position, rotation : (T, 3) m, (T, 3, 3)
        Pose wanted, tremor and drift included.
    velocity, angular_velocity : (T, 3) m/s, (T, 3) rad/s
        Velocity of the intended movement alone: fed into the damper, tremor would only shake.
    """

    position: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    angular_velocity: np.ndarray

    def __post_init__(self) -> None:
        checked(self)
        steps = len(np.atleast_1d(self.position))
        shapes = [array.shape for array in vars(self).values()]
        if shapes != [(steps, 3), (steps, 3, 3), (steps, 3), (steps, 3)]:
            raise ArgumentError(
                f"position, rotation, velocity and angular_velocity have shapes {shapes}; give "
                "(T, 3), (T, 3, 3), (T, 3) and (T, 3)"
            )

    def __len__(self) -> int:
        return len(self.position)

    def seen_from(self, frame: Moving | None, k: int) -> Moving:
        """Pose and twist (6,) wanted at step k, of a path in a frame that moves."""
        R, p, v, w = self.rotation[k], self.position[k], self.velocity[k], self.angular_velocity[k]
        return carried(R, p, v, w, frame)


def carried(
    R: np.ndarray, p: np.ndarray, v: np.ndarray, w: np.ndarray, frame: Moving | None
) -> Moving:
    """Pose and twist (6,) in the world, of a pose (R, p) and velocities (v, w) in a frame."""
    if frame is not None:
        (R_other, p_other), moved = frame
        # For matrices so small, @ costs twice as much.
        arm = R_other.dot(p)
        v = moved[:3] + pin.skew(moved[3:]).dot(arm) + R_other.dot(v)
        w = moved[3:] + R_other.dot(w)
        R, p = R_other.dot(R), p_other + arm
    return Pose(R, p), np.concatenate((v, w))


@dataclass(frozen=True)
class Grip:
    """Spring and damper between a person's hand and a site, with limited strength.

    Parameters
    ----------
    stiffness, damping : float
        N/m and Ns/m.
    angular_stiffness, angular_damping : float
        Nm/rad and Nms/rad; zero for a hand that leads without turning.
    max_force, max_torque : float
        Strength [N], [Nm]: the wrench is scaled down to it.
    """

    stiffness: NotNegative = 2000.0
    damping: NotNegative = 120.0
    angular_stiffness: NotNegative = 60.0
    angular_damping: NotNegative = 2.5
    max_force: Strength = 60.0
    max_torque: Strength = 8.0

    def __post_init__(self) -> None:
        checked(self)

    def wrench(
        self, pose: Pose, twist: np.ndarray, wanted_pose: Pose, wanted_twist: np.ndarray
    ) -> np.ndarray:
        """Force and torque (6,) on the site.

        Parameters
        ----------
        pose, wanted_pose : Pose
            Of the site and of the hand.
        twist, wanted_twist : (6,)
            Linear over angular velocity, world-aligned.
        """
        (R, p), (R_wanted, p_wanted) = pose, wanted_pose
        slip = wanted_twist - twist
        wrench = np.empty(6)
        wrench[:3] = self.stiffness * (p_wanted - p) + self.damping * slip[:3]
        turn = pin.log3(R_wanted.dot(R.T))
        wrench[3:] = self.angular_stiffness * turn + self.angular_damping * slip[3:]
        for part, limit in ((wrench[:3], self.max_force), (wrench[3:], self.max_torque)):
            size = sqrt(part.dot(part))
            if size > limit:
                part *= limit / size
        return wrench

    @border
    def braking(self, mass: NotNegative, inertia: NotNegative, ratio: Positive = 0.5) -> "Grip":
        """The same hand, which brakes what it holds: damped no less than a ratio of critical.

        Parameters
        ----------
        mass, inertia : float
            Of what it holds [kg], [kg m^2]: it would swing in a hand whose damping is small.
        ratio : float
            Least damping over that of the aperiodic limit, 2 (stiffness mass)^1/2.
        """
        moving = 2 * ratio * sqrt(self.stiffness * mass)
        turning = 2 * ratio * sqrt(self.angular_stiffness * inertia)
        return replace(
            self,
            damping=max(self.damping, moving),
            angular_damping=max(self.angular_damping, turning),
        )

    def spends(self, wrench: np.ndarray) -> np.ndarray:
        """Whether wrenches (..., 6) take all of its strength (...)."""
        force, torque = (
            np.linalg.norm(wrench[..., part], axis=-1) for part in (slice(3), slice(3, 6))
        )
        spent: np.ndarray = (force >= 0.999 * self.max_force) & (self.max_force > 0)
        return spent | ((torque >= 0.999 * self.max_torque) & (self.angular_stiffness > 0))


@dataclass(frozen=True)
class Guide:
    """A hand that leads one site of the robot along a path.

    Parameters
    ----------
    name : str
        What the recording calls it: ``<name>_wrench``, ``<name>_point``.
    site : str
        Where the robot is held, and what follows the path.
    grip : Grip
    path : HandPath
        Sampled at the simulation's time step, from ``start`` on.
    relative_to : str, optional
        Site that carries the path's frame: a person who watches one object while moving another.
    start : float
        Time [s] when the hand takes hold; it lets go at the end of the path.
    sight : Sight, optional
        How the person sees, late, and corrects; one who knows all at once by default.
    care : Care
        What the person corrects, with sight.
    """

    name: str
    site: str
    grip: Grip
    path: HandPath
    relative_to: str | None = None
    start: NotNegative = 0.0
    sight: Sight | None = None
    care: Care = EVERYTHING

    def __post_init__(self) -> None:
        checked(self)

    def bind(self, simulation: Simulation) -> "BoundGuide":
        """Look up the names in one simulation."""
        return BoundGuide(self, simulation)


class BoundGuide:
    """A guide in one simulation: ``act`` applies it; ``wrench``, ``point`` are its last."""

    def __init__(self, guide: Guide, simulation: Simulation):
        self.name = guide.name
        self._guide, self._simulation = guide, simulation
        self._body = simulation.attachment(guide.site)[0]
        self._first = round(guide.start / simulation.timestep)
        self.wrench, self.point = np.zeros(6), np.zeros(3)
        self._eyes = None if guide.sight is None else _Eyes(guide, guide.sight, simulation.timestep)

    def act(self, step: int, state: State) -> None:
        """Apply the wrench of this time step."""
        k, site = step - self._first, self._guide.site
        pose, before = state.pose(site), self.wrench
        self.point = pose.position
        if not 0 <= k < len(self._guide.path):
            self.wrench = np.zeros(6)
            return
        other = self._guide.relative_to
        frame = None if other is None else (state.pose(other), state.twist(other))
        if self._eyes is None:
            wanted = self._guide.path.seen_from(frame, k)
        else:
            wanted = self._eyes.wanted(k, pose, frame, before)
        self.wrench = self._guide.grip.wrench(pose, state.twist(site), *wanted)
        self._simulation.apply_wrench(self._body, self.wrench, pose.position)


class _Eyes:
    """What a guide does about what it sees: where it expects its object, what it corrects."""

    def __init__(self, guide: Guide, sight: Sight, timestep: float):
        self._path, self._care, self._grip = guide.path, guide.care, guide.grip
        self._watched = Watched(sight.delay, timestep)
        self._correction = Correction(sight, timestep)

    def wanted(self, k: int, pose: Pose, frame: Moving | None, pulled: np.ndarray) -> Moving:
        """Where the hand leads to at step k, with the site at a pose, the object in a frame.

        ``pulled`` is the wrench (6,) of the step before.
        """
        self._correction.act(
            k,
            lambda: self._error(k, pose, frame),
            lambda: self._care.at(k),
            lambda: not self._grip.spends(pulled),
        )
        expected = None if frame is None else self._watched.expect(*frame)
        (R, p), twist = self._path.seen_from(expected, k)
        base = _base(frame)
        moved, turned = self._correction.now[:3], self._correction.now[3:]
        return Pose(pin.exp3(base.dot(turned)).dot(R), p + base.dot(moved)), twist

    def _error(self, k: int, pose: Pose, frame: Moving | None) -> np.ndarray:
        """What is missing (6,) in the axes of the frame."""
        (R_now, p_now), _ = self._path.seen_from(frame, k)
        missing = p_now - pose.position, pin.log3(R_now @ pose.rotation.T)
        return np.concatenate([_base(frame).T @ part for part in missing])


def _base(frame: Moving | None) -> np.ndarray:
    return _WORLD if frame is None else frame[0].rotation


_WORLD = np.eye(3)
