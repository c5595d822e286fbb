"""Friction of free directions: what nobody pulls back stays where it is put."""

import numpy as np
from scipy.linalg.lapack import dgesv, dsyevd, dtrtrs

from tpsim.errors import ArgumentError
from tpsim.robot.anatomy import felt
from tpsim.robot.state import State
from tpsim.robot.views.nullspace import eye

LOOSE = 0.03
"""Share of a hand's mobility from which on a direction counts as one that the hand decides."""


def felt_mass(state: State) -> float:
    """Mass [kg] that a person feels at a hand, mean over the hands."""
    if not state.robot.hands:
        raise ArgumentError("the robot has no hand; friction is what a person feels at one")
    mass = float(np.mean([felt(state, site)[0] for site in state.robot.hands.values()]))
    if not 0 < mass < np.inf:
        raise ArgumentError(f"a person feels {mass:g} kg at the hands; give the robot inertia")
    return mass


def damping(
    state: State,
    L: np.ndarray,
    V: np.ndarray,
    stiffness: np.ndarray,
    share: np.ndarray,
    friction: float,
    rate: float,
) -> np.ndarray:
    """Damping (n, n) [Nms/rad] of all modes, with friction where there is no stiffness.

    In the coordinates z = L^T q, M = L L^T, with modes V and their stiffness K_z:

    - Every mode is damped as the optimum is, D_z = (2 K_z)^1/2, and a free one, in its share,
      loses its speed at ``rate``.
    - Where a hand is free to go, ``rate`` gives way to the same friction in all directions, so
      that a person feels ``friction`` times the speed whatever the posture. A motion that several
      hands make together is slowed at the first of them alone: friction at the others would have
      to be carried by what couples them, and disturb it.

    All parts are positive semi-definite, so that damping never injects energy.

    Parameters
    ----------
    state : State
    L : (n, n)
        Cholesky factor of the inertia.
    V : (n, n)
        Modes, in the columns.
    stiffness : (n,)
        K_z [1/s^2].
    share : (n,)
        In which modes are free, from 0 to 1.
    friction : float
        [Ns/m]
    rate : float
        [1/s]
    """
    # In the coordinates of the modes, V^T z, shares are factors. (For matrices so small, @ costs
    # twice as much as dot.)
    # What no hand has decided so far, and what is not yet slowed as a hand.
    undecided = slow = eye(len(V))
    D = slow * np.sqrt(2 * stiffness)
    before = None
    for site in state.robot.hands.values():
        if before is not None:
            undecided = _without(undecided, *before)
        rows = dtrtrs(L, state.jacobian(site).T, lower=1)[0].T.dot(V)
        free = rows * share
        mobility = rows.dot(rows.T)
        moves = free[:3].dot(undecided)
        values, U, _ = dsyevd(moves.dot(moves.T))
        most = (U * mobility[:3, :3].dot(U)).sum(0)
        weight = np.maximum(values, 0.0) / (values + LOOSE * most + 1e-12)
        pull = U.T.dot(rows[:3])
        D += (friction * (pull.T * weight)).dot(pull)
        slow = _without(slow, free[:3], mobility[:3, :3])
        before = free, mobility
    D += (rate * (slow.T * share)).dot(slow)
    root = L.dot(V)
    damped: np.ndarray = root.dot(D).dot(root.T)
    return damped


def _without(space: np.ndarray, rows: np.ndarray, mobility: np.ndarray) -> np.ndarray:
    """Projection that is left of a space (n, n) when what rows (m, n) move in it is taken."""
    inside = rows.dot(space)
    decided = inside.dot(inside.T) + LOOSE * mobility
    decided += 1e-12 * mobility.trace() * eye(len(decided))
    # LAPACK directly: numpy's wrapper costs twice the call at this size.
    return space - space.dot(inside.T).dot(dgesv(decided, inside)[2])
