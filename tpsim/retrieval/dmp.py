"""Dynamic movement primitives whose forcing term or attractor is retrieved by GMR (Section 5.1).

The movement is that of a unit mass on a spring and a damper, pulled to a goal and pushed by a
forcing term that fades with a decay s: x'' = K_p (goal - x) - K_v x' + s F(s). The push is the
same as an attractor that moves. Encode [s, F] or [s, attractor] as a mixture, retrieve it with
:func:`tpsim.retrieval.gmr.gmr`, and follow the attractor with a spring and a damper
(:func:`tpsim.control.spring.spring_damper`) or with the gains of optimal control.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.errors import ArgumentError
from tpsim.gaussian import finite_array


class Motion(NamedTuple):
    """Position [m], velocity [m/s] and acceleration [m/s^2] of a movement, each (T, D)."""

    position: NDArray
    velocity: NDArray
    acceleration: NDArray

    @classmethod
    def of(cls, position: ArrayLike, dt: float) -> Motion:
        """Differentiate positions (T, D), T >= 2, by central differences."""
        position = _path("position", position)
        if len(position) < 2:
            raise ArgumentError(f"position {position.shape} needs at least 2 time steps")
        velocity = np.gradient(position, _positive("dt", dt), axis=0)
        return cls(position, velocity, np.gradient(velocity, dt, axis=0))


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
    loss = _positive("rate", rate) * _positive("dt", dt)
    if steps < 1 or loss >= 1:
        raise ArgumentError(f"steps is {steps} and rate*dt {loss}; allowed are >= 1 and < 1")
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
    s = finite_array("s", s)
    if s.shape != motion.position.shape[:1] or not (s > 0).all():
        raise ArgumentError(f"s {s.shape} must be ({len(motion.position)},) and positive")
    pull = stiffness * (finite_array("goal", goal) - motion.position)
    return (motion.acceleration - pull + damping * motion.velocity) / s[:, None]


def attractor_path(motion: Motion, stiffness: float, damping: float) -> NDArray:
    """Attractor (T, D) whose spring and damper produce a motion: x + x' K_v/K_p + x''/K_p."""
    stiffness = _positive("stiffness", stiffness)
    drag = damping * motion.velocity + motion.acceleration
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
    forcing, goal, s = _path("forcing", forcing), finite_array("goal", goal), finite_array("s", s)
    if goal.shape != forcing.shape[1:] or s.shape != forcing.shape[:1]:
        raise ArgumentError(
            f"goal {goal.shape}, forcing {forcing.shape} and s {s.shape} must be (D,), (T, D), (T,)"
        )
    return goal + s[:, None] * forcing / _positive("stiffness", stiffness)


def _path(name: str, path: ArrayLike) -> NDArray:
    path = finite_array(name, path)
    if path.ndim != 2 or 0 in path.shape:
        raise ArgumentError(f"{name} {path.shape} must be (T, D) with at least one step")
    return path


def _positive(name: str, value: float) -> float:
    if not (np.isfinite(value) and value > 0):
        raise ArgumentError(f"{name} is {value}; it must be positive")
    return value
