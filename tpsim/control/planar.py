"""Planar kinematics: serial chains and the two-armed figure of Figs 10 and 11."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import entries, finite_array, number, shown, whole
from tpsim.errors import ArgumentError


@dataclass(frozen=True, init=False)
class PlanarChain(Stored):
    """A serial chain of revolute joints in the plane, angles relative to the previous link.

    Parameters
    ----------
    lengths : sequence of k floats
        Link lengths [m].
    joints : sequence of k ints, optional
        Which entries of the posture q turn the links; by default the first k. Two chains that
        share entries are the arms of one body.
    size : int, optional
        Number n of entries of q; by default the least that holds all joints.

    Raises
    ------
    ArgumentError
        If lengths, joints and size do not fit each other.

    """

    lengths: tuple[float, ...]
    joints: tuple[int, ...]
    size: int

    def __init__(
        self, lengths: ArrayLike, joints: Sequence[int] | None = None, size: int | None = None
    ):
        links = np.atleast_1d(finite_array("lengths", lengths))
        if links.ndim != 1 or not (links > 0).all():
            raise ArgumentError(
                f"lengths {shown(links)}: give a positive length [m] for every link"
            )
        given = range(len(links)) if joints is None else joints
        turned = tuple(whole("joints", joint) for joint in entries("joints", given))
        if not turned or len(turned) != len(links) or len(set(turned)) != len(turned):
            raise ArgumentError(
                f"{len(links)} lengths and joints {turned} given; give one joint per link"
            )
        least = max(turned) + 1
        hint = "joints must be between 0 and size - 1"
        object.__setattr__(self, "lengths", tuple(links.tolist()))
        object.__setattr__(self, "joints", turned)
        object.__setattr__(
            self, "size", least if size is None else whole("size", size, least, hint)
        )

    def points(self, q: ArrayLike) -> np.ndarray:
        """Positions of the base, the joints and the tip (..., k + 1, 2) [m] for q (..., n)."""
        steps = self._links(q)
        base = np.zeros((*steps.shape[:-2], 1, 2))
        return np.concatenate([base, np.cumsum(steps, axis=-2)], axis=-2)

    def position(self, q: ArrayLike) -> np.ndarray:
        """Position of the tip (..., 2) [m] for postures q (..., n) [rad]."""
        return self._links(q).sum(axis=-2)

    def orientation(self, q: ArrayLike) -> np.ndarray:
        """Angle of the last link (..., 1) [rad], not wrapped: a task of one dimension."""
        return self._posture(q)[..., list(self.joints)].sum(axis=-1, keepdims=True)

    def jacobian(self, q: ArrayLike) -> np.ndarray:
        """Analytic Jacobian of :meth:`position` (..., 2, n) [m/rad]."""
        steps = self._links(q)
        lever = np.cumsum(steps[..., ::-1, :], axis=-2)[..., ::-1, :]
        J = np.zeros((*steps.shape[:-2], 2, self.size))
        J[..., 0, self.joints] = -lever[..., 1]
        J[..., 1, self.joints] = lever[..., 0]
        return J

    def orientation_jacobian(self, q: ArrayLike) -> np.ndarray:
        """Jacobian of :meth:`orientation` (..., 1, n), which is constant."""
        J = np.zeros((*self._posture(q).shape[:-1], 1, self.size))
        J[..., self.joints] = 1.0
        return J

    def _links(self, q: ArrayLike) -> np.ndarray:
        """Vectors of the links (..., k, 2) in world axes."""
        angles = np.cumsum(self._posture(q)[..., list(self.joints)], axis=-1)
        return np.stack([np.cos(angles), np.sin(angles)], axis=-1) * np.array(self.lengths)[:, None]

    def _posture(self, q: ArrayLike) -> np.ndarray:
        q = finite_array("q", q)
        if q.ndim < 1 or q.shape[-1] != self.size:
            raise ArgumentError(f"q has shape {q.shape}; this chain needs (..., {self.size})")
        return q


def two_armed(lengths: Sequence[float]) -> tuple[PlanarChain, PlanarChain]:
    """Left and right arm of a body with one trunk link: 5 articulations, Fig. 11.

    Parameters
    ----------
    lengths : sequence of 5 floats
        Trunk, two links of the left arm, two links of the right arm [m].

    Returns
    -------
    left, right : PlanarChain
        Chains over the same posture q = (trunk, left 1, left 2, right 1, right 2).

    """
    links = finite_array("lengths", lengths)
    if links.shape != (5,):
        raise ArgumentError(f"{links.size} lengths given; a two-armed figure has 5 links")
    trunk, *arms = links.tolist()
    left = PlanarChain((trunk, *arms[:2]), joints=(0, 1, 2), size=5)
    right = PlanarChain((trunk, *arms[2:]), joints=(0, 3, 4), size=5)
    return left, right


def numeric_jacobian(function: Callable, q: ArrayLike, step: float = 1e-6) -> np.ndarray:
    """Jacobian of any function of the posture by central differences.

    Parameters
    ----------
    function : callable
        From (n,) [rad] to (m,) or a scalar.
    q : array (n,)
        Posture [rad].
    step : float
        Half of the difference [rad].

    Returns
    -------
    ndarray (m, n)

    """
    q, step = finite_array("q", q), number("step", step, above=0)
    columns = [np.atleast_1d(function(q + d) - function(q - d)) for d in step * np.eye(q.size)]
    return np.stack(columns, axis=-1) / (2.0 * step)
