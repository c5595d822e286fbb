"""Scripted paths of hands that lead an arm through postures: a person who cares how it is bent."""

from collections.abc import Sequence

import numpy as np

from tpsim import rotation
from tpsim.errors import ArgumentError, SimulationError
from tpsim.sim.coordinates.coordinate import Coordinate
from tpsim.sim.hand import Path
from tpsim.sim.robot import Robot
from tpsim.sim.script import Variation, wandering

FADE = 0.5
"""Time [s] over which a hand begins to wander."""


def through(times, postures, timestep: float) -> np.ndarray:
    """Postures (T, n) on the clock: minimum jerk from one via posture to the next, at rest in each.

    Parameters
    ----------
    times : (V,)
        When each via is reached [s]; increasing from 0. Equal neighbours in ``postures`` are a
        rest.
    postures : (V, n)
        rad.
    timestep : float
        Of the clock [s].
    """
    times, postures = np.asarray(times, float), np.asarray(postures, float)
    if times.shape != postures.shape[:1] or len(times) < 2 or not (np.diff(times) > 0).all():
        raise ArgumentError(
            f"times {times.tolist()} do not fit postures of shape {postures.shape}; give at least "
            "two, increasing"
        )
    clock = timestep * (1 + np.arange(round(times[-1] / timestep)))
    segment = np.clip(np.searchsorted(times, clock) - 1, 0, len(times) - 2)
    s = (clock - times[segment]) / np.diff(times)[segment]
    way = s**3 * (10 - 15 * s + 6 * s**2)
    return postures[segment] + way[:, None] * (postures[segment + 1] - postures[segment])


def hand_path(
    robot: Robot, site: str, postures, timestep: float, rng, variation: Variation
) -> Path:
    """Path of a hand on a site that leads the arm along postures (T, n), wandering as hands do."""
    handle = robot.site(site)
    R, p, twist = [], [], []
    for q, dq in zip(postures, np.gradient(postures, timestep, axis=0), strict=True):
        robot.update_kinematics(q)
        rotated, position = robot.placement(handle)
        R.append(rotated.copy())
        p.append(position.copy())
        twist.append(robot.jacobian(handle) @ dq)
    twist = np.array(twist)
    steps = len(p)
    fade = np.minimum(timestep / FADE * np.arange(steps), 1.0)[:, None]
    moved, turned = wandering(steps, timestep, rng, variation)
    return Path(
        np.array(p) + fade * moved,
        rotation.exp(fade * turned) @ np.array(R),
        twist[:, :3],
        twist[:, 3:],
    )


def posture_at(robot: Robot, coordinates: Sequence[Coordinate], start) -> np.ndarray:
    """Posture (n,) at which all coordinates are zero, by Gauss-Newton from a start (n,).

    Raises
    ------
    SimulationError
        If there is none within the joint limits.
    """
    evaluate = [coordinate.bind(robot) for coordinate in coordinates]
    q = np.array(start, float)
    for _ in range(50):
        robot.update_kinematics(q)
        y, J = (np.concatenate(parts) for parts in zip(*(e() for e in evaluate), strict=True))
        if np.abs(y).max() < 1e-6:
            break
        step = np.linalg.lstsq(J, -y, rcond=1e-6)[0]
        q = np.clip(q + step * min(1.0, 0.5 / np.abs(step).max()), robot.lower, robot.upper)
    else:
        names = [coordinate.name for coordinate in coordinates]
        raise SimulationError(
            f"no posture within the joint limits satisfies {names}; "
            f"{np.degrees(np.abs(y).max()):.1f} deg are left"
        )
    return q
