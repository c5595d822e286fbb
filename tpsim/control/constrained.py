"""Linear quadratic tracking within constraints: Eqs (34) and (38) as a quadratic programme."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from tpsim.border import checked
from tpsim.checks import affordable, choice, several
from tpsim.control.constraints import Constraint
from tpsim.control.feedback import Plan, checked_state
from tpsim.control.inequalities import Inequalities, Response
from tpsim.control.lqt import lqt
from tpsim.control.system import LinearSystem
from tpsim.errors import ArgumentError
from tpsim.extras import extra

Infeasible = Literal["raise", "relax"]
"""What to do where no movement keeps all constraints."""

TIGHT = 1e-9
"""Share of a limit's size by which it may be missed: rounding."""

FIRM = 1e8
"""What missing a limit by its size costs, where a movement must, beside the cost of Eq. (34)."""


@dataclass(frozen=True, eq=False)
class ConstrainedPlan(Plan):
    """A plan within constraints.

    Parameters
    ----------
    multipliers : mapping of str to ndarray (T, c)
        Of every constraint by name: how much the cost (Eq. 34) would fall per unit of a limit, at
        most zero where the lower limit binds, at least zero where the upper does.
    missed : mapping of str to float
        The constraints that no movement keeps, and by how much this one misses them at most.
    """

    multipliers: Mapping[str, np.ndarray] = field(default_factory=dict)
    missed: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked(self)


def constrained_lqt(
    means: ArrayLike,
    precisions: ArrayLike,
    system: LinearSystem,
    effort: ArrayLike,
    initial: ArrayLike,
    constraints: Sequence[Constraint],
    *,
    infeasible: Infeasible = "raise",
) -> ConstrainedPlan:
    """Linear quadratic tracking (Eqs 34 and 38) within constraints on states and controls.

    Parameters
    ----------
    means, precisions, system, effort
        As in :func:`tpsim.control.lqt.lqt`.
    initial : array (n,)
        First state xi_1, of which no limit is asked.
    constraints : sequence of Constraint
        What is to be kept at steps 2 ... T, controls at steps 1 ... T - 1.
    infeasible : str
        Where no movement keeps all: ``"raise"`` says which constraints and when; ``"relax"``
        misses those that do not concern the control alone, by as little as it can, and says so in
        ``missed``.

    Returns
    -------
    ConstrainedPlan

    Raises
    ------
    ArgumentError
        As in :func:`lqt`, constraints that do not fit, or that nothing keeps.

    Notes
    -----
    About the unconstrained law the cost is a sum of squares: with u_t = k_t - K_t xi_t + v_t it is
    the least cost plus the sum of v_tᵀ W_t v_t, where W_t = R + Bᵀ P B is the curvature of the
    recursion. What is left is the v of least norm within the constraints, which DAQP finds among
    those that the plan so far has missed; where none binds v is zero, and the plan is that of
    :func:`lqt` to the bit.
    """
    feedback = lqt(means, precisions, system, effort)
    T, m, n = feedback.gain.shape
    constraints = several("constraints", constraints, Constraint)
    choice("infeasible", infeasible, ("raise", "relax"))
    names = [constraint.name for constraint in constraints]
    if len(set(names)) < len(names):
        raise ArgumentError(f"constraints are called {names}; give every one a name of its own")
    affordable("steps", T, T * n * m)
    nominal = feedback.rollout(checked_state(initial, n))
    if not constraints or T == 1:
        return ConstrainedPlan(nominal.states, nominal.controls)
    rows, response = Inequalities.of(constraints, T, n, m), Response.of(feedback)
    firm = np.zeros(len(rows), bool)
    found = _least(rows, response, nominal, firm)
    missed: dict[str, tuple[float, int]] = {}
    if found is None:
        # A control alone can be limited; where even that fails its limits contradict each other.
        found = _least(rows, response, nominal, rows.on_states)
        found = found or _least(rows, response, nominal, ~firm)
        if found is None:
            raise ArgumentError(
                f"from initial, {np.abs(initial).max():.1e} at most, no controls are found that "
                "keep even their own limits; change units, or give wider limits"
            )
        missed = rows.missed(names, found[0])
        if infeasible == "raise":
            which = ", ".join(f"'{k}' (by {v:.3g} from step {t})" for k, (v, t) in missed.items())
            raise ArgumentError(
                f"no movement keeps all constraints; the nearest misses {which}. Give wider "
                "limits, more steps, or infeasible='relax'"
            )
    plan, multipliers = found
    shaped = {}
    for number, constraint in enumerate(constraints):
        mine = rows.number == number
        shaped[constraint.name] = np.zeros((T, constraint.rows))
        shaped[constraint.name][rows.step[mine], rows.row[mine]] = multipliers[mine]
    most = {name: miss for name, (miss, _) in missed.items()}
    return ConstrainedPlan(plan.states, plan.controls, None, shaped, most)


def _least(
    rows: Inequalities, response: Response, nominal: Plan, soft: np.ndarray
) -> tuple[Plan, np.ndarray] | None:
    """The plan of least cost and the multipliers (R,) of its rows; None where there is no plan.

    Rows are taken in as they are missed, so that the programme is as small as what binds; ``soft``
    ones may be missed at a price.
    """
    size, value = rows.size, rows.values(nominal)
    plan, multipliers = nominal, np.zeros(len(rows))
    taken = np.zeros((2, len(rows)), bool)  # lower and upper sides
    while True:
        beyond = rows.beyond(plan)
        new = np.array([beyond < -TIGHT * size, beyond > TIGHT * size]) & ~taken
        if not new.any():
            return plan, multipliers
        taken |= new
        side, some = np.nonzero(taken)
        sign = 2.0 * side - 1.0
        limit = np.where(side, rows.upper[some], rows.lower[some])
        room = sign * (limit - value[some])
        slope = sign[:, None] * rows.slopes(response, some)
        slack = np.diag(size[some] / np.sqrt(FIRM))[:, soft[some]]
        found = _least_norm(np.hstack([slope, -slack]), room, TIGHT * size[some])
        if found is None:
            return None
        z, dual = found
        plan = response.plan(nominal, z[: slope.shape[1]])
        multipliers = np.zeros(len(rows))
        np.add.at(multipliers, some, 2 * sign * dual)


def _least_norm(
    slope: np.ndarray, room: np.ndarray, tight: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """The z of least norm with ``slope z <= room``, and multipliers; None where there is none."""
    with extra("Constraints of lqt", "constraints"):
        from qpsolvers import Problem, solve_problem
    length = np.linalg.norm(slope, axis=1)
    moves = length > 1e-12 * max(length.max(), 1e-300)
    if (room[~moves] < -tight[~moves]).any():
        return None
    dual = np.zeros(len(room))
    rows, limits = slope[moves] / length[moves, None], room[moves] / length[moves]
    # z is a combination of the rows: there are fewer of them than of its entries.
    basis = np.linalg.qr(rows.T)[0]
    k = basis.shape[1]
    problem = Problem(np.eye(k), np.zeros(k), rows @ basis, limits)
    found = solve_problem(problem, solver="daqp", primal_tol=1e-9, dual_tol=1e-12)
    if not found.found or found.z is None:
        return None
    binds = found.z > 1e-12 * found.z.max(initial=0.0)
    # The solver knows which bind; where they meet is a linear system, exact to rounding.
    z, *_ = np.linalg.lstsq(rows[binds], limits[binds])
    force, *_ = np.linalg.lstsq(rows[binds].T, -z)
    share = np.zeros(len(rows))
    share[binds] = force
    dual[moves] = share / length[moves]
    return z, dual
