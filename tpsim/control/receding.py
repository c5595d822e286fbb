"""Linear quadratic tracking over a horizon that moves on with the situation (Eqs 33-38)."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import affordable, finite_array, several
from tpsim.control.constrained import ConstrainedPlan, constrained_lqt
from tpsim.control.constraints import Constraint
from tpsim.control.feedback import checked_state
from tpsim.control.lqt import lqt
from tpsim.control.system import LinearSystem
from tpsim.errors import ArgumentError

Now = Callable[[int, np.ndarray], LinearSystem]
"""The system from step t and a state on."""


def receding_horizon(
    reference: Callable[[int, np.ndarray], tuple],
    system: LinearSystem | Now,
    effort: ArrayLike,
    initial: ArrayLike,
    steps: int,
    *,
    constraints: Sequence[Constraint] | Callable[[int, np.ndarray], Sequence[Constraint]] = (),
) -> ConstrainedPlan:
    """Online tracking: re-plan at every step over a horizon that moves with the situation.

    Parameters
    ----------
    reference : callable
        ``reference(t, state)`` -> (means (H, n), precisions (H, n, n)) from step t on, seen now
        (in the frames as they are now); H may change, and P coordinate systems may lead.
    system : LinearSystem or callable
        Discrete dynamics; or ``system(t, state)``, as they are from step t on: constant over the
        horizon, or with H - 1 steps of their own.
    effort : float or array (m, m)
        Cost of the controls.
    initial : array (n,)
        First state.
    steps : int
        Number of controls to apply.
    constraints : sequence of Constraint, or callable
        What every plan keeps; or ``constraints(t, state)``, as they are from step t on. Where no
        plan keeps all, those on states are missed by as little as can be, and ``missed`` says
        which and by how much a plan missed them at most.

    Returns
    -------
    ConstrainedPlan
        The movement made: states (steps + 1, n) and controls (steps, m), without multipliers.

    Raises
    ------
    ArgumentError
        As in :func:`lqt` and :func:`constrained_lqt`.

    """
    initial = finite_array("initial", initial)
    steps = affordable("steps", steps, initial.size**2, least=0)
    if not callable(reference):
        raise ArgumentError(f"reference is a {type(reference).__name__}; give reference(t, state)")
    states, controls = [initial], []
    missed: dict[str, float] = {}
    for t in range(steps):
        now = _system(system, t, states[-1])
        if not t:
            states = [checked_state(initial, now.size[0])]
        wanted = _answer("reference", reference, t, states[-1])
        if not (isinstance(wanted, tuple | list) and len(wanted) == 2):
            what = type(wanted).__name__
            raise ArgumentError(f"reference returned a {what}; give the two, (means, precisions)")
        means, precisions = wanted
        kept: object = constraints
        if callable(constraints) and not isinstance(constraints, type):
            kept = _answer("constraints", constraints, t, states[-1])
        if kept := several("constraints", kept, Constraint):
            plan = constrained_lqt(
                means, precisions, now, effort, states[-1], kept, infeasible="relax"
            )
            for name, most in plan.missed.items():
                missed[name] = max(most, missed.get(name, 0.0))
            control = plan.controls[0] if len(plan.controls) else np.zeros(now.size[1])
        else:
            control = lqt(means, precisions, now, effort).control(0, states[-1])
        controls.append(control)
        states.append(now.step(states[-1], control, 0))
    if not steps:
        now = _system(system, 0, states[0])
        states = [checked_state(initial, now.size[0])]
    m = now.size[1]
    return ConstrainedPlan(np.array(states), np.array(controls).reshape(-1, m), missed=missed)


def _answer(name: str, asked: Callable, t: int, state: np.ndarray) -> object:
    try:
        return asked(t, state)
    except TypeError as error:
        raise ArgumentError(f"{name} cannot be called as {name}(t, state): {error}") from error


def _system(system: object, t: int, state: np.ndarray) -> LinearSystem:
    found = _answer("system", system, t, state) if callable(system) else system
    if not isinstance(found, LinearSystem):
        raise ArgumentError(
            f"system is a {type(found).__name__}; give integrator(dim, dt), or system(t, state) "
            "that returns a LinearSystem"
        )
    if found is system and found.steps is not None:
        raise ArgumentError(
            f"the system changes over {found.steps} steps, and the horizon moves on; give "
            "system(t, state), the system from step t on"
        )
    return found
