"""Paths on manifolds unrolled onto R^n: linear quadratic tracking of poses, however far they turn.

A path is rolled along a plane without slipping or twisting (Cartan's development): its steps,
``log`` of each point at the one before, are carried back along the path by parallel transport and
added up. There a point that moves on with constant velocity moves on a straight line, a double
integrator on the manifold is one of R^n, and all of Section 6 holds: exactly on the path, and to
first order of the distance from it. No rotation is the origin, and none is too large: after ten
turns about an axis the coordinate is ten turns.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import checked
from tpsim.checks import LARGEST, finite_array, frozen, instance, whole
from tpsim.control.feedback import Feedback
from tpsim.control.lqt import lqt
from tpsim.control.system import LinearSystem
from tpsim.errors import ArgumentError
from tpsim.gaussian import symmetric
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold

ROUNDS = 3
"""Times that a tracked path is unrolled anew about its own solution."""

STILL = 1e-3
"""Distance [rad] between two solutions after which no other is worth while."""


@dataclass(frozen=True, eq=False)
class Unrolled:
    """A path on a manifold and its coordinates on the plane.

    Parameters
    ----------
    manifold : Manifold
    points : (T, width)
    axes : (T, dim, dim)
        Tangent coordinates at every point of the plane's axes, in the columns: orthonormal.
    plane : (T, dim)
        The path on the plane, from zero.
    """

    manifold: Manifold
    points: np.ndarray
    axes: np.ndarray
    plane: np.ndarray

    def __post_init__(self) -> None:
        checked(self)
        points = self.manifold.points("points", self.points)
        T, dim = len(points) if points.ndim == 2 else 0, self.manifold.dim
        if not T or self.axes.shape != (T, dim, dim) or self.plane.shape != (T, dim):
            raise ArgumentError(
                f"points, axes and plane have shapes {points.shape}, {self.axes.shape} and "
                f"{self.plane.shape}; give (T, {self.manifold.width}), (T, {dim}, {dim}) and "
                f"(T, {dim}), T >= 1"
            )
        object.__setattr__(self, "points", frozen(points))

    @classmethod
    def of(cls, manifold: Manifold, points: ArrayLike) -> "Unrolled":
        """Unroll a path (T, width)."""
        x = instance("manifold", manifold, Manifold, "such as R(3) * S3").points("points", points)
        if x.ndim != 2 or not len(x):
            raise ArgumentError(f"points have shape {x.shape}; give (T, {manifold.width}), T >= 1")
        steps = manifold.work.log(x[:-1], x[1:])
        axes = np.empty((len(x), manifold.dim, manifold.dim))
        axes[0] = np.eye(manifold.dim)
        for t, turn in enumerate(manifold.work.transport(x[:-1], x[1:])):
            axes[t + 1] = turn @ axes[t]
        plane = np.zeros((len(x), manifold.dim))
        plane[1:] = np.cumsum((axes[:-1].mT @ steps[..., None])[..., 0], axis=0)
        return cls(manifold, x, axes, plane)

    def __len__(self) -> int:
        return len(self.points)

    def see(self, step: int, point: ArrayLike) -> np.ndarray:
        """Where points (..., width) lie on the plane (..., dim), as seen from the path at a step.

        Parameters
        ----------
        step : int
        point : (..., width)
        """
        t = whole("step", step, most=len(self) - 1)
        v = self.manifold.work.log(self.points[t], self.manifold.points("point", point))
        return self.plane[t] + v @ self.axes[t]

    def roll(self, step: int, plane: ArrayLike) -> np.ndarray:
        """Points (..., width) that lie at (..., dim) on the plane, as seen from a step.

        Parameters
        ----------
        step : int
        plane : (..., dim)
        """
        t = whole("step", step, most=len(self) - 1)
        v = finite_array("plane", plane)
        if v.shape[-1:] != (self.manifold.dim,) or (v.size and np.abs(v).max() > LARGEST):
            raise ArgumentError(f"plane has shape {v.shape}; give (..., {self.manifold.dim})")
        return self.manifold.work.exp(self.points[t], (v - self.plane[t]) @ self.axes[t].T)

    def rolled(self, plane: ArrayLike) -> np.ndarray:
        """Points (T, width) that lie at (T, dim) on the plane, each as seen from its own step.

        Parameters
        ----------
        plane : (T, dim)
        """
        v = finite_array("plane", plane)
        if v.shape != self.plane.shape:
            raise ArgumentError(f"plane has shape {v.shape}; give {self.plane.shape}")
        if np.abs(v).max() > LARGEST:
            raise ArgumentError(f"plane reaches {np.abs(v).max():.1e}; give {LARGEST:.0e} at most")
        v = (self.axes @ (v - self.plane)[..., None])[..., 0]
        return self.manifold.work.exp(self.points, v)

    def place(self, gaussian: RiemannianGaussian) -> tuple[np.ndarray, np.ndarray]:
        """Means (..., T, dim) and precisions (..., T, dim, dim) of Gaussians on the plane.

        Parameters
        ----------
        gaussian : RiemannianGaussian (..., T)
        """
        g = instance("gaussian", gaussian, RiemannianGaussian)
        if g.manifold != self.manifold or g.mean.shape[-2:-1] != (len(self),):
            raise ArgumentError(
                f"gaussian is on {g.manifold} with leading axes {g.mean.shape[:-1]}; give (..., "
                f"{len(self)}) on {self.manifold}"
            )
        return self._placed(g.mean, g.precision)

    def _placed(self, means: np.ndarray, precisions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, slope = self.manifold.work.seen(self.points, means)
        back = slope @ self.axes
        mean = self.plane + (self.axes.mT @ v[..., None])[..., 0]
        return mean, symmetric(back.mT @ precisions @ back)


@dataclass(frozen=True, eq=False)
class ManifoldPlan:
    """Tracking on a manifold: a law on the plane, and the path about which it was unrolled.

    Parameters
    ----------
    path : Unrolled
    feedback : Feedback
        For the state [place, velocity] on the plane.
    """

    path: Unrolled
    feedback: Feedback

    def __post_init__(self) -> None:
        checked(self)
        dim, gain = self.path.manifold.dim, self.feedback.gain.shape
        if gain != (len(self.path), dim, 2 * dim):
            raise ArgumentError(
                f"feedback has gains of shape {gain}; the path asks for "
                f"({len(self.path)}, {dim}, {2 * dim})"
            )

    def acceleration(self, step: int, point: ArrayLike, velocity: ArrayLike) -> np.ndarray:
        """Control (dim,) in tangent coordinates at the path's point of a step.

        Parameters
        ----------
        step : int
        point : (width,)
        velocity : (dim,)
            In tangent coordinates at the path's point, as an angular velocity is.
        """
        t = whole("step", step, most=len(self.path) - 1)
        axes, speed = self.path.axes[t], self._speed(velocity)
        state = np.concatenate([self.path.see(t, self._place(point)), axes.T @ speed])
        found: np.ndarray = axes @ self.feedback.control(t, state)
        return found

    def rollout(self, point: ArrayLike, velocity: ArrayLike | None = None) -> np.ndarray:
        """Points (T, width) of the movement that the law makes.

        Parameters
        ----------
        point : (width,)
            From where.
        velocity : (dim,), optional
            There; zero by default.
        """
        dim = self.path.manifold.dim
        speed = np.zeros(dim) if velocity is None else self._speed(velocity)
        start = np.concatenate([self.path.see(0, self._place(point)), self.path.axes[0].T @ speed])
        states = self.feedback.rollout(start).states
        return self.path.rolled(states[:, :dim])

    def _place(self, point: ArrayLike) -> np.ndarray:
        found = self.path.manifold.points("point", point)
        if found.ndim != 1:
            raise ArgumentError(f"point has shape {found.shape}; give ({found.shape[-1]},)")
        return found

    def _speed(self, velocity: ArrayLike) -> np.ndarray:
        dim, speed = self.path.manifold.dim, finite_array("velocity", velocity)
        if speed.shape != (dim,):
            raise ArgumentError(f"velocity has shape {speed.shape}; give ({dim},)")
        if np.abs(speed).max() > LARGEST:
            raise ArgumentError(
                f"velocity reaches {np.abs(speed).max():.1e}; give {LARGEST:.0e} at most"
            )
        return speed


def lqt_on(
    reference: RiemannianGaussian,
    system: LinearSystem,
    effort: ArrayLike,
    initial: ArrayLike | None = None,
) -> ManifoldPlan:
    """Linear quadratic tracking on a manifold by a double integrator, Eqs (34-38).

    The reference is unrolled (:class:`Unrolled`), tracked on the plane, and rolled back; twice or
    thrice, about the solution before. In R^n it is :func:`tpsim.lqt`.

    Parameters
    ----------
    reference : RiemannianGaussian (T,) or (P, T)
        In one coordinate system or, on one manifold, in P of them, whose information is added up.
    system : LinearSystem
        Double integrator of the manifold's tangent coordinates, ``integrator(dim, dt)``.
    effort : float or (dim, dim)
        Cost of acceleration.
    initial : (width,), optional
        Point from which the movement starts, at rest; default the reference's first.
    """
    g = instance("reference", reference, RiemannianGaussian)
    if g.mean.ndim not in (2, 3):
        raise ArgumentError(f"reference has leading axes {g.mean.shape[:-1]}; give (T,) or (P, T)")
    many = g if g.mean.ndim == 3 else g[None]
    n, m = instance("system", system, LinearSystem, "integrator(dim, dt)").B.shape
    if (n, m) != (2 * g.dim, g.dim):
        raise ArgumentError(
            f"system has {n} states and {m} controls; reference lies on {g.manifold}, which asks "
            f"for a double integrator, integrator({g.dim}, dt)"
        )
    nominal, first = many.mean[-1], many.mean[-1, 0] if initial is None else initial
    for _ in range(ROUNDS):
        path = Unrolled.of(g.manifold, nominal)
        plan = ManifoldPlan(path, tracked(path, many.mean, many.precision, system, effort))
        before, nominal = nominal, plan.rollout(first)
        if g.manifold.flat or g.manifold.distance(before, nominal).max() < STILL:
            break
    return plan


def tracked(
    path: Unrolled,
    means: np.ndarray,
    precisions: np.ndarray,
    system: LinearSystem,
    effort: ArrayLike,
) -> Feedback:
    """Law on the plane that tracks points (P, T, width) of precisions (P, T, dim, dim).

    Velocities are free.
    """
    means, precisions = path._placed(means, precisions)
    P, T, d = means.shape
    states, weights = np.zeros((P, T, 2 * d)), np.zeros((P, T, 2 * d, 2 * d))
    states[..., :d], weights[..., :d, :d] = means, precisions
    return lqt(states, weights, system, effort)
