"""Gaussians on manifolds: normal in the tangent space at their mean.

The density is that of normal coordinates at the mean, ``N(log_mean(x); 0, covariance)``: in R^n it
is the Gaussian. Seen from another point x, a covariance is carried by ``slope``, the derivative of
``log``: parallel transport, stretched across the way by angle over sine. Carried so, products and
conditionals agree with the density to first order of the spread at any distance.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import Seed, finite_array, frozen, instance, picked
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Dimensions, Gaussian, symmetric
from tpsim.manifold.manifold import Factors, Manifold
from tpsim.manifold.product import EXACT, fused, mixed


@dataclass(frozen=True, eq=False, init=False)
class RiemannianGaussian(Gaussian):
    """Gaussians on a manifold, one for every index of the leading axes.

    Parameters
    ----------
    manifold : Manifold
    mean : (..., width)
        Points; brought onto the manifold.
    covariance : (..., dim, dim)
        In tangent coordinates at the mean [m], [rad].

    Raises
    ------
    ArgumentError
        Shapes that the manifold does not fit, points that are none, or no covariances.
    """

    manifold: Manifold

    def __init__(self, manifold: Manifold, mean: ArrayLike, covariance: ArrayLike):
        manifold = instance("manifold", manifold, Manifold, "such as R(3) * S3")
        mean = manifold.points("mean", mean)
        covariance = finite_array("covariance", covariance)
        if covariance.shape[-2:] != (manifold.dim, manifold.dim):
            raise ArgumentError(
                f"covariance has shape {covariance.shape}; {manifold} has {manifold.dim} tangent "
                f"coordinates: give (..., {manifold.dim}, {manifold.dim})"
            )
        try:
            lead = np.broadcast_shapes(mean.shape[:-1], covariance.shape[:-2])
        except ValueError as error:
            raise ArgumentError(
                f"leading axes of mean {mean.shape} and covariance {covariance.shape} differ"
            ) from error
        spread = Gaussian(np.zeros((*lead, manifold.dim)), covariance)
        mean = np.broadcast_to(mean, (*lead, manifold.width))
        object.__setattr__(self, "manifold", manifold)
        object.__setattr__(self, "mean", frozen(np.array(mean)))
        object.__setattr__(self, "covariance", spread.covariance)

    @classmethod
    def trusted_on(
        cls, manifold: Manifold, mean: np.ndarray, covariance: np.ndarray
    ) -> "RiemannianGaussian":
        """Build without checks and copies, from arrays that are valid by construction."""
        gaussian = object.__new__(cls)
        gaussian.__dict__.update(
            manifold=manifold, mean=frozen(mean), covariance=frozen(covariance)
        )
        return gaussian

    @property
    def dim(self) -> int:
        """Number of tangent coordinates."""
        return self.manifold.dim

    def __getitem__(self, index: object) -> "RiemannianGaussian":
        """Select along the leading axes."""
        index = index if isinstance(index, tuple) else (index,)
        return RiemannianGaussian.trusted_on(
            self.manifold,
            picked(self.mean, (*index, Ellipsis, slice(None))),
            picked(self.covariance, (*index, Ellipsis, slice(None), slice(None))),
        )

    @cached_property
    def spread(self) -> Gaussian:
        """The Gaussian (..., dim) in the tangent space at the mean, about zero."""
        return Gaussian.trusted(np.zeros((*self.mean.shape[:-1], self.dim)), self.covariance)

    def log(self, x: ArrayLike) -> np.ndarray:
        """Tangent vectors (..., dim) at the mean that lead to points (..., width)."""
        x = self.manifold.points("x", x)
        try:
            return self.manifold.work.log(self.mean, x)
        except ValueError:
            raise ArgumentError(
                f"x has leading axes {x.shape[:-1]}, the mean {self.mean.shape[:-1]}; they must "
                "broadcast, as in x[..., None, :]"
            ) from None

    def log_density(self, x: ArrayLike) -> np.ndarray:
        """Log density of points ``x`` (..., width), broadcast against the leading axes.

        In normal coordinates at the mean; quaternions of either sign are the same.
        """
        return self.spread.log_density(self.log(x))

    def sample(self, rng: Seed, size: int | tuple[int, ...] = ()) -> np.ndarray:
        """Draw points, shape ``size`` + (..., width); ``rng`` is a Generator or a seed."""
        return self.manifold.work.exp(self.mean, self.spread.sample(rng, size))

    def marginal(self, dims: Dimensions) -> "RiemannianGaussian":
        """Distribution of some columns of the points alone; curved factors as a whole."""
        return self._marginal(self.manifold.part("dims", dims))

    def _marginal(self, part: Factors) -> "RiemannianGaussian":
        return RiemannianGaussian.trusted_on(
            part.manifold,
            self.mean[..., part.columns],
            self.covariance[..., part.rows[:, None], part.rows],
        )

    def condition(
        self, value: ArrayLike, given: Dimensions, of: Dimensions | None = None
    ) -> "RiemannianGaussian":
        """Distribution of the columns ``of`` when ``given`` have a value, Eqs (14-15).

        The conditional in the tangent space at the mean, carried to where it ends.

        Parameters
        ----------
        value : (..., I)
            Points of the factors given.
        given, of : one or several int
            Columns; those of a direction or a quaternion together. ``of`` is all others by default.
        """
        inputs, outputs = split(self.manifold, given, of)
        found = self.spread.condition(self._marginal(inputs).log(value), inputs.rows, outputs.rows)
        return shifted(outputs.manifold, self.mean[..., outputs.columns], found)

    def affine(self, A: ArrayLike, b: ArrayLike = 0.0) -> "RiemannianGaussian":
        """Distribution after a frame's map of the columns, Eqs (1-2); see :meth:`Manifold.frame`.

        Parameters
        ----------
        A : (..., width, width)
        b : (..., width)
        """
        A, b = finite_array("A", A), finite_array("b", b)
        frame = self.manifold.frame(Frame(A, b if b.ndim else np.full(A.shape[-2:-1], b)))
        mean = frame.to_common(self.mean)
        turn = self.manifold.work.turned(frame.A, self.mean, mean)
        return RiemannianGaussian.trusted_on(
            self.manifold, mean, symmetric(turn @ self.covariance @ turn.mT)
        )

    def _product(self, factors: Sequence[Gaussian]) -> "RiemannianGaussian":
        """Product of factors: the point of greatest density, by Gauss-Newton, and its spread."""
        manifold = self.manifold
        if any(getattr(g, "manifold", None) != manifold for g in factors):
            words = [str(getattr(g, "manifold", f"R({g.dim})")) for g in factors]
            raise ArgumentError(f"the gaussians live on {', '.join(words)}; give one manifold")
        try:
            lead = np.broadcast_shapes(*(g.mean.shape[:-1] for g in factors))
        except ValueError as error:
            raise ArgumentError(f"leading axes of the gaussians do not match ({error})") from error
        means = np.stack([np.broadcast_to(g.mean, (*lead, manifold.width)) for g in factors])
        square = (*lead, manifold.dim, manifold.dim)
        precisions = np.stack([np.broadcast_to(g.precision, square) for g in factors])
        found = fused(manifold, means, precisions, still=EXACT)
        return RiemannianGaussian.trusted_on(manifold, *found)

    def _mixed(self, weights: np.ndarray) -> "RiemannianGaussian":
        found = mixed(self.manifold, weights, self.mean, self.covariance)
        return RiemannianGaussian.trusted_on(self.manifold, *found)


def split(manifold: Manifold, given: Dimensions, of: Dimensions | None) -> tuple[Factors, Factors]:
    """Columns given and asked for."""
    inputs = manifold.part("given", given)
    others = np.setdiff1d(np.arange(manifold.width), inputs.columns)
    outputs = manifold.part("of", others if of is None else of)
    if np.intersect1d(inputs.columns, outputs.columns).size:
        raise ArgumentError(
            f"given {inputs.columns} and of {outputs.columns} overlap; keep them disjoint"
        )
    return inputs, outputs


def shifted(manifold: Manifold, base: np.ndarray, tangent: Gaussian) -> RiemannianGaussian:
    """Gaussian about the point to which a Gaussian in the tangent space at ``base`` leads."""
    mean, carry = manifold.work.departing(base, tangent.mean)
    return RiemannianGaussian.trusted_on(
        manifold, mean, symmetric(carry @ tangent.covariance @ carry.mT)
    )


def carried(manifold: Manifold, x: np.ndarray, y: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Covariances (..., dim, dim) at points x in tangent coordinates at y."""
    if not manifold.work.curved:
        return covariance
    _, carry = manifold.work.carrying(y, x)
    return symmetric(carry @ covariance @ carry.mT)
