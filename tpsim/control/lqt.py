"""Finite-horizon linear quadratic tracking: recursive and batch (Eqs 33-38)."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg.lapack import dposv

from tpsim.border import unchecked
from tpsim.checks import HUGE, flag
from tpsim.control.feedback import Feedback, Plan, checked_state
from tpsim.control.optimality import solve_optimality
from tpsim.control.system import LinearSystem
from tpsim.control.tracking import TrackingProblem, tracking_problem
from tpsim.errors import ArgumentError
from tpsim.gaussian import unit_variances


def lqt(
    means: ArrayLike, precisions: ArrayLike, system: LinearSystem, effort: ArrayLike
) -> Feedback:
    """Linear quadratic tracking by backward recursion, minimising Eq. 34 (or Eq. 38).

    Parameters
    ----------
    means : array (T, n) or (P, T, n)
        Reference mu_t, in one coordinate system or in P of them (Eq. 38), whose information is
        added up. Where the precision is zero its value does not matter.
    precisions : array (T, n, n) or (P, T, n, n)
        Symmetric positive semi-definite weights Λ_t. They may be singular and change over time
        (via points: zero at all other steps).
    system : LinearSystem
        Discrete dynamics with n states and m controls, of T - 1 steps where they change over time.
    effort : float, array (m, m) or (T, m, m)
        Cost R of the controls, positive. It may be zero (a matrix: semi-definite) where the
        precision alone determines every control.

    Returns
    -------
    Feedback
        gain (T, m, n) and feedforward (T, m): u_t = k_t - K_t xi_t.

    Raises
    ------
    ArgumentError
        If shapes do not fit, a precision is indefinite, or a control stays undetermined.

    """
    problem = tracking_problem(means, precisions, system, effort)
    return _feedback(problem, *_backward(problem))


def lqt_batch(
    means: ArrayLike,
    precisions: ArrayLike,
    system: LinearSystem,
    effort: ArrayLike,
    initial: ArrayLike | None = None,
    *,
    covariance: bool = False,
) -> Plan:
    """Linear quadratic tracking as one weighted least squares problem, Eqs 35-37 (or Eq. 38).

    States, controls and multipliers of the dynamics solve one banded system, so the cost is
    linear in T; S^u is never formed.

    Parameters
    ----------
    means, precisions, system, effort
        As in :func:`lqt`.
    initial : array (n,) or None
        First state xi_1. None leaves it free, to be found with the rest, as in trajectory
        retrieval (Eq. 30); the precisions must then determine it.
    covariance : bool
        Also return the covariance of the states for a known first state, the diagonal blocks of
        S^u (S^uᵀ Σ_s⁻¹ S^u + R)⁻¹ S^uᵀ.

    Returns
    -------
    Plan
        states (T, n), controls (T - 1, m), and covariance (T, n, n) if asked for.

    Raises
    ------
    ArgumentError
        As in :func:`lqt`, or if the size of ``initial`` is wrong.

    """
    problem = tracking_problem(means, precisions, system, effort)
    if initial is not None:
        initial = checked_state(initial, system.size[0])
    covariance = flag("covariance", covariance)
    if not problem.strict or initial is None or covariance:
        policy, curvature = _backward(problem, free_start=initial is None)
    states, controls = solve_optimality(problem, initial)
    spread = _feedback(problem, policy, curvature).covariance() if covariance else None
    return Plan(states, controls[:-1], spread)


def _backward(problem: TrackingProblem, free_start: bool = False):
    """Policy (T, m, n + 1) and curvature (T, m, m) by dynamic programming.

    The cost-to-go is one quadratic form in (xi, 1). A step back adds the control to it and
    takes the Schur complement over u, whose minimiser is -policy (xi, 1).
    """
    n, m = problem.system.size
    T = len(problem.eta)
    k = n + 1
    stage = np.zeros((T, k + m, k + m))
    stage[:, :n, :n] = problem.Lambda
    stage[:, :n, n] = stage[:, n, :n] = -problem.eta
    stage[:, k:, k:] = problem.R
    varies = problem.system.steps is not None
    dynamics = np.zeros((T - 1 if varies else min(T - 1, 1), k, k + m))
    some = slice(len(dynamics))
    dynamics[:, :n, :n], dynamics[:, :n, k:] = problem.A[some], problem.B[some]
    dynamics[:, n, n] = 1.0
    transposed = np.ascontiguousarray(dynamics.mT)
    policy, curvature = np.zeros((T, m, k)), stage[:, k:, k:].copy()
    value = stage[-1, :k, :k]
    for t in range(T - 2, -1, -1):
        now = t if varies else 0
        step = stage[t] + transposed[now] @ value @ dynamics[now]
        cross = step[k:, :k]
        _, policy[t], failed = dposv(step[k:, k:], cross)
        if failed:
            raise ArgumentError(
                f"the control at step {t} is undetermined: effort is singular and no precision "
                "after it sees the control; give a positive effort"
            )
        curvature[t] = step[k:, k:]
        value = step[:k, :k] - cross.T @ policy[t]
    if free_start:
        _check_start(value[:n, :n])
    return policy, curvature


def _feedback(problem, policy, curvature):
    n = problem.eta.shape[1]
    if not np.abs(policy).max() < HUGE:
        raise ArgumentError("precisions, effort and system give gains without end; check units")
    return unchecked(
        Feedback,
        gain=np.array(policy[:, :, :n]),
        feedforward=-policy[:, :, n],
        system=problem.system,
        curvature=curvature,
    )


def _check_start(P):
    values = np.linalg.eigvalsh(unit_variances(P))
    if values[0] <= 1e-14 * values[-1]:
        raise ArgumentError(
            "the free first state is undetermined by the precisions; give an initial state"
        )
