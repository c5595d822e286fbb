"""What controllers by the product of frames share: that product, its modes, and the optimum."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dpotrf, dsyevd, dtrtrs

from tpsim.border import Positive
from tpsim.controllers.optimal import OptimalImpedance
from tpsim.controllers.product import Information, Product, Skill, posture_skill
from tpsim.errors import ArgumentError, SimulationError
from tpsim.gaussian import Gaussian
from tpsim.learning.free_movement import LOST
from tpsim.robot.state import State
from tpsim.robot.views.joints import Joints
from tpsim.world.impedance import Impedance

NOTHING = 1e-12
"""Precision [1/(kg m^2)] that is none."""


class Intervention(OptimalImpedance):
    """A controller by the product of all frames of all skills (Eqs 5-6).

    Parameters
    ----------
    skills : sequence of Skill
    prior : Gaussian (n,), optional
        Joint posture [rad] for directions that no frame determines.
    period, effort, bandwidth
        As of :class:`~tpsim.controllers.optimal.OptimalImpedance`.
    """

    def __init__(
        self,
        skills: Sequence[Skill],
        prior: Gaussian | None,
        period: Positive,
        effort: Positive | None,
        bandwidth: Positive | None,
    ):
        super().__init__(period, effort, bandwidth)
        self.skills, self.prior = tuple(skills), prior
        self._product: Product | None = None

    def product(self, state: State) -> Information:
        """The product of all frames at a state.

        Raises
        ------
        ArgumentError
            At the first state, if no frame determines how some joint moves.
        """
        if self._product is None:
            skills = list(self.skills)
            if self.prior is not None:
                skills.append(posture_skill(self.prior, {"prior": Joints()}))
            self._product = Product(skills)
            found = self._product.at(state)
            check_determined(replace(found, precision=self._product.seen), state)
            return found
        return self._product.at(state)

    def optimum(self, product: Information, state: State) -> Impedance:
        """Impedance towards the product of all frames: frozen M and J, closed form.

        In the coordinates z = L^T q with M = L L^T every direction has unit inertia, and the cost
        of acceleration ``r |ddz|^2 = r ddq^T M ddq`` is the same for every direction. With the
        Jacobian ``J_z = J L^-T`` and the precision ``Lambda_z = J_z^T W J_z``,

            K_z = (Lambda_z / r)^1/2,  D_z = (2 K_z)^1/2,
            tau = L [ K_z L^T (q_hat - q) - D_z L^T dq ] + bias.

        It is the optimum for M, J and W that stay as they are; they are frozen until the next
        renewal, and over the whole horizon nothing is claimed. The stiffness ``L K_z L^T`` is
        symmetric and does not depend on the choice of joint coordinates; all modes are damped
        alike. From one renewal to the next it is not the gradient of one potential: led round a
        loop it may give or take energy, which the tank bounds (:mod:`tpsim.world.tank`).
        """
        modes = UnitInertia.of(product, state).modes()
        root = modes.inertia_root.dot(modes.vectors)
        stiffness = self.stiffness(modes.precision, state.robot)
        return Impedance.of_modes(root, stiffness, state.q + modes.way)


@dataclass(frozen=True, eq=False)
class Modes:
    """The product of all frames in coordinates z = L^T q, in which all inertia is one.

    Parameters
    ----------
    inertia_root : (n, n)
        L, with M = L L^T.
    vectors : (n, n)
        Of the precision in z, in the columns.
    precision : (n,)
        Its eigenvalues, ascending.
    way : (n,)
        From the posture to the optimum [rad].
    """

    inertia_root: np.ndarray
    vectors: np.ndarray
    precision: np.ndarray
    way: np.ndarray


@dataclass(frozen=True, eq=False)
class UnitInertia:
    """The product of all frames in coordinates z = L^T q, before its modes are looked for.

    Parameters
    ----------
    inertia_root : (n, n)
        L, with M = L L^T.
    jacobian : (m, n)
        Of the stacked views, J L^-T.
    precision : (n, n)
    gradient : (n,)
        Of the log-likelihood; zero at the optimum.
    """

    inertia_root: np.ndarray
    jacobian: np.ndarray
    precision: np.ndarray
    gradient: np.ndarray

    @classmethod
    def of(cls, product: Information, state: State) -> "UnitInertia":
        """A product at a state."""
        J, y, W = product.jacobian, product.value, product.precision
        L = dpotrf(state.mass, lower=1)[0]
        # (J L^-T)^T: the Jacobian with respect to z.
        Jz = dtrtrs(L, J.T, lower=1)[0]
        # At this size @ costs twice as much as dot, and numpy's wrapper a third of LAPACK's call.
        JW = Jz.dot(W)
        gradient = Jz.dot(product.target) - JW.dot(y)
        return cls(L, Jz.T, JW.dot(Jz.T), gradient)

    def modes(self) -> Modes:
        """Eigenvectors of the precision, and the way to the optimum."""
        L = self.inertia_root
        values, V, failed = dsyevd(self.precision)
        if failed:
            raise SimulationError("the precision of the frames has no eigendecomposition")
        # At a singular posture a frame may lose its last direction: no pull there, not infinity.
        np.maximum(values, max(1e-9 * values[-1], NOTHING), out=values)
        # Way to the optimum of each mode: Lambda_z^-1 times the gradient.
        way = dtrtrs(L, V.dot(V.T.dot(self.gradient) / values), lower=1, trans=1)[0]
        return Modes(L, V, values, way)


def check_determined(product: Information, state: State) -> None:
    """Raise ArgumentError where no frame determines how some joint moves."""
    values, V = np.linalg.eigh(product.jacobian.T @ product.precision @ product.jacobian)
    if values[0] > LOST * values[-1]:
        return
    weakest = int(np.argmax(np.abs(V[:, 0])))
    raise ArgumentError(
        f"no frame determines the motion of joint '{state.robot.joints[weakest]}'; "
        "give a prior Gaussian on the joint posture"
    )
