"""Scripted paths of hands that lead an arm through postures: a person who cares how it is bent."""

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from tpsim import rotation
from tpsim.border import Positive, Range, border
from tpsim.checks import finite_array, shown
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.timeline import rest_to_rest
from tpsim.world.people.care import Care
from tpsim.world.people.guide import HandPath
from tpsim.world.people.script import Variation, steps_in, wandering

FADE = 0.5
"""Time [s] over which a hand begins to wander."""


@border
def through(times: ArrayLike, postures: ArrayLike, timestep: Positive) -> np.ndarray:
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
    times, postures = finite_array("times", times), finite_array("postures", postures)
    if (
        times.ndim != 1
        or postures.ndim != 2
        or times.shape != postures.shape[:1]
        or len(times) < 2
        or not (np.diff(times) > 0).all()
    ):
        raise ArgumentError(
            f"times {shown(times)} do not fit postures of shape {postures.shape}; give at least "
            "two, increasing"
        )
    clock = timestep * (1 + np.arange(steps_in("times", times[-1] - times[0], timestep)))
    segment = np.clip(np.searchsorted(times, clock) - 1, 0, len(times) - 2)
    s = (clock - times[segment]) / np.diff(times)[segment]
    way = rest_to_rest(s)
    return postures[segment] + way[:, None] * (postures[segment + 1] - postures[segment])


@border
def hand_path(
    robot: Robot,
    site: str,
    postures: np.ndarray,
    timestep: Annotated[float, Range(least=1e-9)],
    rng: np.random.Generator,
    variation: Variation,
    care: Care | None = None,
) -> HandPath:
    """Path of a hand on a site that leads the arm along postures (T, n), wandering as hands do.

    ``care`` says what matters and when, where attention makes the hand steadier.
    """
    if postures.ndim != 2 or len(postures) < 2 or postures.shape[1] != robot.n:
        raise ArgumentError(f"postures have shape {postures.shape}; give (T, {robot.n}), T >= 2")
    R, p, twist = [], [], []
    for q, dq in zip(postures, np.gradient(postures, timestep, axis=0), strict=True):
        state = robot.at(q, dq)
        pose = state.pose(site)
        R.append(pose.rotation)
        p.append(pose.position)
        twist.append(state.twist(site))
    velocity = np.array(twist)
    steps = len(p)
    fade = np.minimum(timestep / FADE * np.arange(steps), 1.0)[:, None]
    moved, turned = wandering(velocity, timestep, rng, variation, care)
    return HandPath(
        np.array(p) + fade * moved,
        rotation.exp(fade * turned) @ np.array(R),
        velocity[:, :3],
        velocity[:, 3:],
    )
