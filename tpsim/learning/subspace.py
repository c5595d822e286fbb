"""Covariance structures: from spherical to full, by way of subspaces (Section 4, App. B).

Every structure answers three questions: how it fits a scatter matrix, how it starts, and how
many free parameters it has. EM, :mod:`tpsim.learning.em`, is the same for all of them, for plain
and for task-parameterized mixtures.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from tpsim.archive import Part
from tpsim.checks import shown, whole
from tpsim.errors import ArgumentError
from tpsim.gaussian import symmetric
from tpsim.learning.regularisation import Regularisation

Factors = tuple[np.ndarray, ...]

SWEEPS = 100  # of factor analysis on the first covariance, before EM begins


class Structure(Protocol):
    """What EM asks of a covariance structure."""

    name: str

    def fit(
        self, S: np.ndarray, factors: Factors | None, limit: Regularisation
    ) -> tuple[np.ndarray, Factors | None]:
        """Fit scatter matrices (G, K, D, D): covariances of this structure, and new factors."""

    def start(self, covariance: np.ndarray, limit: Regularisation) -> Factors | None:
        """Find factors for covariances (G, K, D, D) of any structure."""

    def free_parameters(self, dim: int) -> int:
        """Count the free parameters of one covariance of dimension ``dim``."""


@dataclass(frozen=True)
class Full(Part):
    """Full covariance, Eq. (52)."""

    name = "full"

    def fit(self, S, factors, limit):
        """Keep the scatter as it is."""
        return limit.full(limit.scatter(S)), None

    def start(self, covariance, limit):
        """Need no factors."""
        return None

    def free_parameters(self, dim):
        """D (D + 1) / 2."""
        return dim * (dim + 1) // 2


@dataclass(frozen=True)
class Diagonal(Full):
    """Diagonal covariance: variables that do not know each other."""

    name = "diagonal"

    def fit(self, S, factors, limit):
        """Keep the variances."""
        return _diagonal(limit.variances(_variances(limit.scatter(S)))), None

    def free_parameters(self, dim):
        """D."""
        return dim


@dataclass(frozen=True)
class Spherical(Full):
    """Isotropic covariance: one variance for all directions."""

    name = "spherical"

    def fit(self, S, factors, limit):
        """Keep the mean variance."""
        variance = limit.isotropic(_variances(limit.scatter(S)).mean(-1, keepdims=True))
        return _diagonal(np.broadcast_to(variance, S.shape[:-1])), None

    def free_parameters(self, dim):
        """One."""
        return 1


@dataclass(frozen=True)
class _Subspace(Part):
    """A structure with a subspace of dimension ``dimension``, d."""

    dimension: int

    def __post_init__(self) -> None:
        name = f"subspace dimension of {type(self).__name__}"
        object.__setattr__(self, "dimension", whole(name, self.dimension, least=1))

    def subspace(self, dim: int) -> int:
        """Dimension used in a space of dimension ``dim``: a subspace is smaller than it."""
        return min(self.dimension, whole("dim", dim, least=1) - 1)

    def start(self, covariance, limit):
        """Need no factors."""
        return None

    def free_parameters(self, dim):
        """D d - d (d - 1) / 2 for the subspace, and one for the noise."""
        d, dim = self.subspace(dim), int(dim)
        return dim * d - d * (d - 1) // 2 + 1


@dataclass(frozen=True)
class HDDC(_Subspace):
    """High-dimensional data clustering: d eigenvectors, spherical noise outside, Eqs (9-10).

    Parameters
    ----------
    dimension : int
        Subspace dimension d, lowered to D - 1 in frames that are smaller.
    """

    name = "hddc"

    def fit(self, S, factors, limit):
        """Replace the last D - d eigenvalues by their mean, Eq. (10)."""
        D = S.shape[-1]
        d = self.subspace(D)
        eigenvalues, V = np.linalg.eigh(limit.scatter(S))
        eigenvalues[..., : D - d] = eigenvalues[..., : D - d].mean(-1, keepdims=True)
        eigenvalues = limit.isotropic(eigenvalues)
        return symmetric((V * eigenvalues[..., None, :]) @ V.mT), None


@dataclass(frozen=True)
class _Analysers(_Subspace, ABC):
    """Loadings Lambda and noise: Sigma = Lambda Lambda' + diagonal."""

    def fit(self, S, factors, limit):
        """Do one step of EM from ``factors``, which are Lambda and the variances of the noise."""
        S = limit.scatter(S)
        if factors is None:
            factors = self.start(S, limit)
        loadings, noise = self._step(S, factors, limit)
        diagonal = _diagonal(np.broadcast_to(noise, S.shape[:-1]))
        return symmetric(loadings @ loadings.mT) + diagonal, (loadings, noise)

    @abstractmethod
    def _step(self, S, factors, limit):
        """Loadings (..., D, d) and noise (..., D) or (..., 1) after one step of EM on S."""


@dataclass(frozen=True)
class MFA(_Analysers):
    """Mixture of factor analysers: Sigma = Lambda Lambda' + diagonal, Eqs (11) and (57-63).

    A component is distributed as in Eq. (54), whose covariance is that of Eq. (11).

    Parameters
    ----------
    dimension : int
        Number of factors d, lowered to D - 1 in frames that are smaller.
    """

    name = "mfa"

    def start(self, covariance, limit):
        """Principal factors of the correlations, then sweeps of factor analysis."""
        variances = limit.variances(_variances(covariance))
        scale = np.sqrt(variances)
        correlation = covariance / (scale[..., :, None] * scale[..., None, :])
        off_diagonal = correlation - _diagonal(_variances(correlation))
        loadings = scale[..., None] * _principal(off_diagonal, self.subspace(scale.shape[-1]))
        factors = loadings, variances
        for _ in range(SWEEPS):
            factors = self._step(covariance, factors, limit)
        return factors

    def _step(self, S, factors, limit):
        """Eqs (60-63)."""
        L, psi = factors
        scaled = L / psi[..., None]
        # B = L' (L L' + Psi)^-1, Eq. (63), through a d x d inverse (Woodbury).
        B = np.linalg.solve(_identity(L) + L.mT @ scaled, scaled.mT)
        BS = B @ S
        moment = _identity(L) - B @ L + BS @ B.mT
        loadings = np.linalg.solve(symmetric(moment), BS).mT
        noise = _variances(S) - np.einsum("...ij,...ji->...i", loadings, BS)
        return loadings, limit.variances(np.maximum(noise, 0.0))

    def free_parameters(self, dim):
        """D d - d (d - 1) / 2 for the loadings, and D for the noise."""
        return super().free_parameters(dim) + int(dim) - 1


@dataclass(frozen=True)
class MPPCA(_Analysers):
    """Mixture of probabilistic principal component analysers, Eqs (64-68).

    Parameters
    ----------
    dimension : int
        Number of components d, lowered to D - 1 in frames that are smaller.
    """

    name = "mppca"

    def start(self, covariance, limit):
        """Principal components of the covariance, then sweeps of the analyser on it."""
        noise = _variances(covariance).mean(-1, keepdims=True)
        rest = covariance - noise[..., None] * np.eye(covariance.shape[-1])
        factors = _principal(rest, self.subspace(covariance.shape[-1])), limit.isotropic(noise)
        for _ in range(SWEEPS):
            factors = self._step(covariance, factors, limit)
        return factors

    def _step(self, S, factors, limit):
        """Eqs (64-68)."""
        L, noise = factors
        M = L.mT @ L + noise[..., None] * _identity(L)
        SL = S @ L
        solved = np.linalg.solve(M, SL.mT)  # M^-1 L' S
        loadings = np.linalg.solve((noise[..., None] * _identity(L) + solved @ L).mT, SL.mT).mT
        residual = _variances(S).sum(-1) - np.einsum("...ji,...ij->...", solved, loadings)
        return loadings, limit.isotropic(np.maximum(residual, 0.0)[..., None] / S.shape[-1])


FULL = Full()
_BY_NAME = {"full": FULL, "diagonal": Diagonal(), "spherical": Spherical()}


def structure_of(covariance: object) -> Structure:
    """Structure by its name, ``"full"``, ``"diagonal"``, ``"spherical"``, or itself."""
    if isinstance(covariance, Full | HDDC | MFA | MPPCA):
        return covariance
    if isinstance(covariance, str) and covariance in _BY_NAME:
        return _BY_NAME[covariance]
    raise ArgumentError(
        f"covariance is {shown(covariance)}; give 'full', 'diagonal', 'spherical', HDDC(d), MFA(d) "
        "or MPPCA(d)"
    )


def _principal(matrix: np.ndarray, d: int) -> np.ndarray:
    """Loadings (..., D, d) along the leading eigenvectors; none of them zero, where EM sticks."""
    eigenvalues, V = np.linalg.eigh(matrix)
    least = 1e-12 * np.abs(eigenvalues).max(-1, keepdims=True)
    lengths = np.maximum(np.abs(eigenvalues), least)
    return (V * np.sqrt(lengths)[..., None, :])[..., ::-1][..., :d]


def _variances(matrix: np.ndarray) -> np.ndarray:
    return np.diagonal(matrix, axis1=-2, axis2=-1)


def _diagonal(variances: np.ndarray) -> np.ndarray:
    return variances[..., None] * np.eye(variances.shape[-1])


def _identity(loadings: np.ndarray) -> np.ndarray:
    return np.eye(loadings.shape[-1])
