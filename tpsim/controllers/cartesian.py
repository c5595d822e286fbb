"""Impedance that an expert sets by hand: springs on views, in N/m and Nm/rad."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.border import Positive, border, checked
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.controllers.seeking import PERIOD, Reference, gains, moving, seek
from tpsim.errors import ArgumentError, SimulationError
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.world.impedance import Impedance


@dataclass(frozen=True, eq=False)
class Spring:
    """A spring that pulls a view to a reference.

    Parameters
    ----------
    view : View
        A hand in the world, or one hand seen from the other: the spring is then between the two.
    stiffness : float, (d,) or (d, d)
        [N/m] and [Nm/rad]: for all dimensions, for each, or a symmetric matrix of them.
    reference : (d,) or callable, optional
        Where it pulls to [m], [rad], or ``reference(time) -> (value, velocity)``; zero by default.
    """

    view: View
    stiffness: float | Sequence[float] | np.ndarray
    reference: Reference | None = None

    def __post_init__(self) -> None:
        checked(self)

    def matrix(self, size: int) -> np.ndarray:
        """Stiffness (d, d) of a view of d dimensions.

        Raises
        ------
        ArgumentError
            If it is of another shape, or no spring: not symmetric, or negative.
        """
        K = np.asarray(self.stiffness, float)
        if K.ndim < 2:
            return np.diag(gains("stiffness", K, size))
        if K.shape != (size, size) or not np.allclose(K, K.T):
            raise ArgumentError(
                f"stiffness has shape {K.shape} for a view of {size} dimensions; give a number, "
                f"{size} of them, or a symmetric ({size}, {size})"
            )
        if np.linalg.eigvalsh(K)[0] < -1e-9 * np.abs(K).max():
            raise ArgumentError("stiffness has negative eigenvalues: it would push, not pull")
        return K


class CartesianImpedance(RenewedImpedance):
    """Springs on views, a posture beneath them, and one damping ratio for all modes.

    The springs of views y_j with Jacobians J_j make the joint stiffness and the pull

        K = sum_j J_j^T K_j J_j,    g = sum_j J_j^T K_j (r_j - y_j),

    so that a slow push at a view meets K_j. With the inertia M = L L^T and the eigenvectors V and
    eigenvalues k of L^-1 K L^-T, every mode is a unit mass on a spring k [1/s^2], damped alike:

        tau = g + L V [ (k_f - k) V^T L^T (q0 - q) - 2 ratio k_f^1/2 V^T L^T dq ] + bias,
        k_f = max(k, k0).

    Beneath the springs the posture q0 holds: modes that no spring reaches get the stiffness k0,
    and there it is the dynamically consistent nullspace spring k0 (M - J^T Lambda J), which moves
    no view; softer modes than k0 are filled up to it. The damping follows from the inertia that
    each spring feels. Both are symmetric: with J and M held still, the energy of springs and
    motion only falls. References that move, move the reference of the joints with them.

    Parameters
    ----------
    springs : sequence of Spring
    posture : (n,)
        q0 [rad].
    posture_stiffness : float
        k0 [1/s^2], as acceleration.
    damping : float
        Ratio; 1 is critical.
    period : float
        Time for which an impedance lasts [s]; the torque follows the state at each of them.
    """

    @border
    def __init__(
        self,
        springs: Sequence[Spring],
        posture: np.ndarray,
        *,
        posture_stiffness: Positive = 4.0,
        damping: Positive = 1.0,
        period: Positive = PERIOD,
    ):
        super().__init__(period)
        if not springs:
            raise ArgumentError("no spring was given; give at least one")
        self.springs, self.posture = tuple(springs), np.array(posture, float)
        self.posture_stiffness, self.damping = posture_stiffness, damping
        self._stiffness: np.ndarray | None = None

    def renew(self, state: State, time: float) -> Impedance:
        """Springs, posture and damping about a state."""
        sought = [seek(spring.view, spring.reference, state) for spring in self.springs]
        if self._stiffness is None:
            sizes = [len(one.error) for one in sought]
            pairs = zip(self.springs, sizes, strict=True)
            self._stiffness = block_diag(*(spring.matrix(size) for spring, size in pairs))
        error, velocity, J = (np.concatenate(parts) for parts in zip(*sought, strict=True))
        L = dpotrf(state.mass, lower=1)[0]
        # (J L^-T)^T: the Jacobian in coordinates of unit inertia.
        Jz = dtrtrs(L, J.T, lower=1)[0]
        JK = Jz @ self._stiffness
        k, V, failed = dsyevd(JK @ Jz.T)
        if failed:
            raise SimulationError("the stiffness of the springs has no eigendecomposition")
        k = np.maximum(k, 0.0)
        filled = np.maximum(k, self.posture_stiffness)
        pull = V.T @ (JK @ error) + (filled - k) * (V.T @ (L.T @ (self.posture - state.q)))
        # Back to joints: where all springs are slack, and how fast that place moves.
        way = dtrtrs(L, V @ (pull / filled), lower=1, trans=1)[0]
        pace = dtrtrs(L, V @ ((V.T @ (JK @ velocity)) / filled), lower=1, trans=1)[0]
        modes = L @ V
        now = Impedance(
            (modes * filled) @ modes.T,
            (modes * (2 * self.damping * np.sqrt(filled))) @ modes.T,
            state.q + way,
        )
        return moving(now, pace, state)
