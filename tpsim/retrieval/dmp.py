"""Dynamic movement primitives whose forcing term or attractor is retrieved by GMR (Section 5.1).

The movement is that of a unit mass on a spring and a damper, pulled to a goal and pushed by a
forcing term that fades with a decay s: x'' = K_p (goal - x) - K_v x' + s F(s). The push is the
same as an attractor that moves. Encode [s, F] or [s, attractor] as a mixture, retrieve it with
:func:`tpsim.retrieval.gmr.gmr`, and follow the attractor with a spring and a damper
(:func:`tpsim.control.spring.spring_damper`) or with the gains of optimal control.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.archive import Stored
from tpsim.checks import (
    HUGE,
    affordable,
    array_of,
    finite_array,
    frozen_array,
    instance,
    matrix,
    number,
    stamps,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Motion(Stored):
    """Position [m], velocity [m/s] and acceleration [m/s^2] of a movement, each (T, D)."""

    position: NDArray
    velocity: NDArray
    acceleration: NDArray

    def __post_init__(self) -> None:
        for name in ("position", "velocity", "acceleration"):
            object.__setattr__(self, name, frozen_array(name, matrix(name, getattr(self, name))))
        if not self.position.shape == self.velocity.shape == self.acceleration.shape:
            raise ArgumentError(
                f"position {self.position.shape}, velocity {self.velocity.shape} and acceleration "
                f"{self.acceleration.shape} must be equally many (T, D)"
            )

    @classmethod
    def of(cls, position: ArrayLike | Demonstration, dt: ArrayLike | None = None) -> Motion:
        """Differentiate positions by central differences.

        Parameters
        ----------
        position
            (T, D), T >= 2, or a demonstration, which has its own stamps.
        dt
            Time step [s], or the stamps (T,) [s].

        Notes
        -----
        Velocity is exact inside for movements of constant acceleration, evenly sampled or not;
        the acceleration of an uneven one is exact there as well.
        """
        if isinstance(position, Demonstration):
            return cls.of(position.data, position.time)
        position = matrix("position", position)
        if len(position) < 2:
            raise ArgumentError(f"position {position.shape} needs at least 2 time steps")
        if dt is None:
            raise ArgumentError("dt is missing; give a time step [s], the stamps, a Demonstration")
        if array_of("dt", dt).ndim == 0:
            time = number("dt", dt, above=0) * np.arange(len(position))
        else:
            time = stamps("dt", dt)
        if len(time) != len(position):
            raise ArgumentError(
                f"position has {len(position)} samples and dt {len(time)} stamps; give one each"
            )
        origin = position[0]  # far from zero, differences of small weights would lose digits
        velocity = np.gradient(position - origin, time, axis=0)
        return cls(position, velocity, np.gradient(velocity, time, axis=0))


def decay(steps: int, dt: float, rate: float = 1.0) -> NDArray:
    """Decay term (T,) that starts at 1 and drives the movement in place of time.

    Parameters
    ----------
    steps
        Number of time steps T.
    dt
        Time step [s].
    rate
        Decay rate alpha [1/s]: s_{t+1} = s_t (1 - alpha dt).
    """
    loss = number("rate", rate, above=0) * number("dt", dt, above=0)
    steps = affordable("steps", steps)
    if loss >= 1:
        raise ArgumentError(f"rate*dt is {loss}; allowed are steps that leave something, < 1")
    return (1 - loss) ** np.arange(steps)


def forcing_term(
    motion: Motion, goal: ArrayLike, s: ArrayLike, stiffness: float, damping: float
) -> NDArray:
    """Forcing term F (T, D) that a demonstrated motion needs on the way to its goal.

    Parameters
    ----------
    motion
        Demonstration, T steps.
    goal
        (D,), the attractor of the spring.
    s
        (T,), positive; see :func:`decay`.
    stiffness
        K_p of the spring [1/s^2].
    damping
        K_v of the damper [1/s].
    """
    instance("motion", motion, Motion)
    s = finite_array("s", s)
    if s.shape != motion.position.shape[:1] or not (s > 0).all():
        raise ArgumentError(f"s {s.shape} must be ({len(motion.position)},) and positive")
    stiffness = number("stiffness", stiffness, above=0)
    damping = number("damping", damping, least=0)
    goal = finite_array("goal", goal)
    if goal.shape != motion.position.shape[1:]:
        raise ArgumentError(f"goal {goal.shape} must be {motion.position.shape[1:]}")
    pull = stiffness * (goal - motion.position)
    needed = motion.acceleration - pull + damping * motion.velocity
    if not np.abs(needed).max(initial=0.0) < HUGE * min(s.min(), 1.0):
        raise ArgumentError(f"s falls to {s.min():.1e}: what it scales has no end; give larger s")
    forcing: NDArray = needed / s[:, None]
    return forcing


def attractor_path(motion: Motion, stiffness: float, damping: float) -> NDArray:
    """Attractor (T, D) whose spring and damper produce a motion: x + x' K_v/K_p + x''/K_p."""
    instance("motion", motion, Motion)
    stiffness = number("stiffness", stiffness, above=0)
    drag = number("damping", damping, least=0) * motion.velocity + motion.acceleration
    return motion.position + drag / stiffness


def forced_attractor(
    goal: ArrayLike, forcing: ArrayLike, s: ArrayLike, stiffness: float
) -> NDArray:
    """Attractor (T, D) that has the effect of a goal and a forcing term: goal + s F / K_p.

    Parameters
    ----------
    goal
        (D,), where the movement ends as s fades.
    forcing
        Forcing term F (T, D), retrieved with :func:`tpsim.retrieval.gmr.gmr`.
    s
        (T,), the decay of :func:`decay`.
    stiffness
        K_p of the spring [1/s^2].
    """
    forcing, goal, s = matrix("forcing", forcing), finite_array("goal", goal), finite_array("s", s)
    if goal.shape != forcing.shape[1:] or s.shape != forcing.shape[:1]:
        raise ArgumentError(
            f"goal {goal.shape}, forcing {forcing.shape} and s {s.shape} must be (D,), (T, D), (T,)"
        )
    return goal + s[:, None] * forcing / number("stiffness", stiffness, above=0)
