"""What a finite-horizon controller hands on: a feedback law over time, and a plan."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.border import checked
from tpsim.checks import finite_array, whole
from tpsim.control.system import LinearSystem
from tpsim.covariance import symmetric
from tpsim.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Plan(Stored):
    """A trajectory of a linear system with the controls that make it.

    Parameters
    ----------
    states : ndarray (T, n)
        Trajectory xi_1 ... xi_T.
    controls : ndarray (T - 1, m)
        Controls u_1 ... u_{T-1}.
    covariance : ndarray (T, n, n) or None
        Covariance of the states where it was asked for (:func:`lqt_batch`).

    """

    states: np.ndarray
    controls: np.ndarray
    covariance: np.ndarray | None = None

    def __post_init__(self) -> None:
        checked(self)


@dataclass(frozen=True, eq=False)
class Feedback(Stored):
    """Time-varying feedback and feedforward, u_t = k_t - K_t xi_t (Section 6).

    Parameters
    ----------
    gain : ndarray (T, m, n)
        K_t; zero at the last step, where no control has an effect any more.
    feedforward : ndarray (T, m)
        k_t.
    system : LinearSystem or None
        The dynamics it was made for; needed by roll-outs.
    curvature : ndarray (T, m, m) or None
        R + Bᵀ P_{t+1} B, the Hessian of the cost-to-go in u_t; needed by :meth:`covariance`.

    """

    gain: np.ndarray
    feedforward: np.ndarray
    system: LinearSystem | None = None
    curvature: np.ndarray | None = None

    def __post_init__(self) -> None:
        checked(self)

    def control(self, t: int, state: np.ndarray) -> np.ndarray:
        """Control u_t (..., m) at step t for a measured state (..., n)."""
        t, state = whole("t", t), finite_array("state", state)
        if t >= len(self.gain) or state.shape[-1:] != self.gain.shape[-1:]:
            raise ArgumentError(
                f"t is {t} and state has shape {state.shape}; this feedback has {len(self.gain)} "
                f"steps, for states (..., {self.gain.shape[-1]})"
            )
        control: np.ndarray = self.feedforward[t] - state @ self.gain[t].T
        return control

    def rollout(self, initial: ArrayLike) -> Plan:
        """Trajectory from an initial state (n,) under this feedback.

        Parameters
        ----------
        initial : array (n,)
            First state xi_1.

        Returns
        -------
        Plan
            states (T, n), controls (T - 1, m).

        Raises
        ------
        ArgumentError
            If the initial state has another size, or the feedback knows no system.

        """
        _, closed, drift = self._closed_loop()
        states = np.empty((len(self.gain), closed.shape[-1]))
        states[0] = checked_state(initial, closed.shape[-1])
        for t, (F, f) in enumerate(zip(closed, drift, strict=True)):
            states[t + 1] = F @ states[t] + f
        controls = self.feedforward[:-1] - (self.gain[:-1] @ states[:-1, :, None])[..., 0]
        return Plan(states, controls)

    def covariance(self) -> np.ndarray:
        """Covariance (T, n, n) of the trajectory around its plan, from a known first state.

        The diagonal blocks of S^u (S^uᵀ Σ_s⁻¹ S^u + R)⁻¹ S^uᵀ, the uncertainty of the least
        squares estimate Eq. 37, by one forward pass: u_t varies by the inverse curvature.
        """
        B, closed, _ = self._closed_loop()
        if self.curvature is None:
            raise ArgumentError("this feedback has no curvature; make it with lqt()")
        noise = B @ np.linalg.inv(symmetric(self.curvature[:-1])) @ B.mT
        covariance = np.zeros((len(self.gain), *closed.shape[1:]))
        for t, F in enumerate(closed):
            covariance[t + 1] = F @ covariance[t] @ F.T + noise[t]
        return covariance

    def _closed_loop(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Matrices B (T - 1, n, m), A - B K_t (T - 1, n, n), and the drifts B k_t (T - 1, n)."""
        if self.system is None:
            raise ArgumentError("this feedback knows no system; give one or make it with lqt()")
        A, B = self.system.over(len(self.gain) - 1)
        return B, A - B @ self.gain[:-1], (B @ self.feedforward[:-1, :, None])[..., 0]


def checked_state(state: ArrayLike, n: int) -> np.ndarray:
    """The state as an array (n,), or an ArgumentError."""
    state = finite_array("initial", state)
    if state.shape != (n,):
        raise ArgumentError(f"initial has shape {state.shape}; give a state of {n} finite numbers")
    return state
