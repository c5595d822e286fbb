"""Operational-space control with priorities, as an expert sets it by hand.

O. Khatib, "A unified approach for motion and force control of robot manipulators: the operational
space formulation", IEEE Journal on Robotics and Automation 3(1), 1987; several priorities as in
L. Sentis and O. Khatib, "Synthesis of whole-body behaviors through hierarchical control of
behavioral primitives", International Journal of Humanoid Robotics 2(4), 2005.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.border import Positive, border, checked
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.controllers.seeking import PERIOD, Reference, gains, moving, positive, seek
from tpsim.errors import ArgumentError
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.world.impedance import Impedance

SINGULAR = 0.05
"""Mobility [1/kg], [1/(kg m^2)] below which the arm counts as unable to move a view."""


@dataclass(frozen=True, eq=False)
class Aim:
    """A view that is to come to a reference as a damped unit mass would.

    Parameters
    ----------
    view : View
    gain : float or (d,)
        kp [1/s^2]: acceleration for an error, for all dimensions or for each.
    reference : (d,) or callable, optional
        Where it is to be [m], [rad], or ``reference(time) -> (value, velocity)``; zero by default.
    damping : float
        Ratio: the gain of velocity is kd = 2 ratio kp^1/2.
    """

    view: View
    gain: float | Sequence[float] | np.ndarray
    reference: Reference | None = None
    damping: Positive = 1.0

    def __post_init__(self) -> None:
        checked(self)
        for gain in np.ravel(self.gain):
            positive("gain", gain)


class Prioritised(NamedTuple):
    """What aims ask for, in coordinates z = L^T q of unit inertia: u = S (z_hat - z) - D (dz).

    Parameters
    ----------
    stiffness, damping : (n, n)
    way : (n,)
        From here to the posture z_hat that satisfies the aims in their order, to first order.
    pace : (n,)
        How fast that posture moves.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    way: np.ndarray
    pace: np.ndarray


def prioritised(
    aims: Sequence[Aim],
    state: State,
    L: np.ndarray,
    posture: tuple[np.ndarray, float, float],
    singular: float = SINGULAR,
) -> Prioritised:
    """Aims, the first one first, and a posture beneath them all.

    With ``J_i`` in coordinates z = L^T q and the projector P_i (P_1 = I),

        B_i = (J_i P_i)^+,  u_i = u_{i-1} + B_i (a_i - J_i u_{i-1}),  P_{i+1} = P_i - B_i J_i P_i,

    where ``a_i = kp (r - y) + kd (dr - dy)``. With M = L L^T these are Khatib's dynamically
    consistent inverse and nullspace: what a lower priority asks for accelerates no higher one.
    Where the arm is singular B_i is bounded. What J_i changes by along the movement is left out.

    Parameters
    ----------
    aims : sequence of Aim
    state : State
    L : (n, n)
        Lower root of the inertia; the identity for kinematics alone.
    posture : ((n,), float, float)
        q0 [rad], its gain [1/s^2] and damping ratio.
    singular : float
        Eigenvalue of ``J_i P_i J_i^T`` below which the arm counts as unable to move the view.
    """
    n = state.robot.n
    P, S, D = np.eye(n), np.zeros((n, n)), np.zeros((n, n))
    way, pace = np.zeros(n), np.zeros(n)
    for aim in aims:
        error, velocity, jacobian = seek(aim.view, aim.reference, state)
        kp = gains("gain", aim.gain, len(error))
        kd = 2 * aim.damping * np.sqrt(kp)
        J = dtrtrs(L, jacobian.T, lower=1)[0].T
        JP = J @ P
        mobility, U, _ = dsyevd(JP @ JP.T)
        B = JP.T @ (U / np.maximum(mobility, singular)) @ U.T
        S += B @ (kp[:, None] * J - J @ S)
        D += B @ (kd[:, None] * J - J @ D)
        way += B @ (error - J @ way)
        pace += B @ (velocity - J @ pace)
        P -= B @ JP
    q0, gain, ratio = posture
    S += P @ (gain * np.eye(n) - S)
    D += P @ (2 * ratio * gain**0.5 * np.eye(n) - D)
    way += P @ (L.T @ (q0 - state.q) - way)
    return Prioritised(S, D, way, pace)


class OperationalSpace(RenewedImpedance):
    """Aims with priorities, dynamically consistent, and a posture in what they leave.

    ``tau = L u + bias`` with u of :func:`prioritised` and M = L L^T: each aim sees a unit mass
    with the poles of ``s^2 + kd s + kp``, whatever the arm weighs, and none that comes after
    moves it. As an impedance: stiffness ``L S L^T``, damping ``L D L^T`` about the posture that
    satisfies the aims in their order. With several gains S is not symmetric: no potential energy
    belongs to it, and passivity is not claimed.

    Parameters
    ----------
    aims : sequence of Aim
        The first one has priority over all others, and so on.
    posture : (n,)
        q0 [rad].
    posture_gain : float
        [1/s^2]
    damping : float
        Ratio of the posture.
    period : float
        Time for which an impedance lasts [s]; the torque follows the state at each of them.
    """

    @border
    def __init__(
        self,
        aims: Sequence[Aim],
        posture: np.ndarray,
        *,
        posture_gain: Positive = 4.0,
        damping: Positive = 1.0,
        period: Positive = PERIOD,
    ):
        super().__init__(period)
        if not aims:
            raise ArgumentError("no aim was given; give at least one")
        self.aims, self.posture = tuple(aims), np.array(posture, float)
        self.posture_gain, self.damping = posture_gain, damping

    def renew(self, state: State, time: float) -> Impedance:
        """The aims about a state."""
        L = dpotrf(state.mass, lower=1)[0]
        posture = self.posture, self.posture_gain, self.damping
        S, D, way, pace = prioritised(self.aims, state, L, posture)
        to_joints = dtrtrs(L, np.stack([way, pace], axis=1), lower=1, trans=1)[0]
        now = Impedance(L @ S @ L.T, L @ D @ L.T, state.q + to_joints[:, 0])
        return moving(now, to_joints[:, 1], state)
