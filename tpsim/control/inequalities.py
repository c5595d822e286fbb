"""All inequalities of a plan in rows, and what of a plan misses them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.control.constraints import Constraint
from tpsim.control.feedback import Feedback, Plan

MISSED = 1e-6
"""Share of a limit's size from which on a plan counts as missing it."""


@dataclass(frozen=True, eq=False)
class Inequalities:
    """``lower <= C xi_t + D u_t <= upper`` of all constraints and steps, one row for each.

    Parameters
    ----------
    number, step, row : (R,)
        Number of the constraint, its step t, and its row there.
    C, D : (R, n), (R, m)
    lower, upper : (R,)
    """

    number: np.ndarray
    step: np.ndarray
    row: np.ndarray
    C: np.ndarray
    D: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @classmethod
    def of(cls, constraints: Sequence[Constraint], T: int, n: int, m: int) -> "Inequalities":
        """Those of a movement of T states (n,) and T - 1 controls (m,)."""
        parts: list[list[np.ndarray]] = []
        for number, constraint in enumerate(constraints):
            C, D, lower, upper = constraint.over(T, n, m)
            acts = np.zeros((T, constraint.rows), bool)
            # The first state is given; with the last one there is no control any more.
            acts[1:] = C[1:].any(-1)
            acts[:-1] |= D[:-1].any(-1)
            acts[-1] &= ~D[-1].any(-1)
            acts &= np.isfinite(lower) | np.isfinite(upper)
            t, c = np.nonzero(acts)
            several = np.full(len(t), number)
            parts.append([several, t, c, C[t, c], D[t, c], lower[t, c], upper[t, c]])
        return cls(*(np.concatenate(column) for column in zip(*parts, strict=True)))

    def __len__(self) -> int:
        return len(self.step)

    @property
    def on_states(self) -> np.ndarray:
        """Whether a row concerns a state (R,)."""
        return np.asarray(self.C.any(-1))

    @property
    def size(self) -> np.ndarray:
        """Of a row's limits (R,), beside which a miss is judged; one where both are zero."""
        sides = [np.abs(np.where(np.isfinite(x), x, 0.0)) for x in (self.lower, self.upper)]
        size = np.maximum(*sides)
        return np.where(size > 0, size, 1.0)

    def values(self, plan: Plan) -> np.ndarray:
        """What a plan comes to in every row (R,)."""
        controls = np.vstack([plan.controls, np.zeros((1, self.D.shape[1]))])
        found: np.ndarray = (self.C * plan.states[self.step]).sum(-1)
        return found + (self.D * controls[self.step]).sum(-1)

    def beyond(self, plan: Plan) -> np.ndarray:
        """By how much a plan is above the upper limits (positive), below the lower (negative)."""
        value = self.values(plan)
        above: np.ndarray = np.maximum(value - self.upper, 0.0)
        return above + np.minimum(value - self.lower, 0.0)

    def missed(self, names: Sequence[str], plan: Plan) -> dict[str, tuple[float, int]]:
        """By how much and from which step on a plan misses constraints, by name."""
        beyond, found = np.abs(self.beyond(plan)), {}
        for number, name in enumerate(names):
            rows = np.flatnonzero((self.number == number) & (beyond > MISSED * self.size))
            if len(rows):
                found[name] = float(beyond[rows].max()), int(self.step[rows].min())
        return found

    def slopes(self, response: "Response", some: np.ndarray) -> np.ndarray:
        """How some rows answer to z (rows, N)."""
        step = self.step[some]
        found: np.ndarray = (self.C[some][:, None] @ response.states[step])[:, 0]
        acts = step < len(response.controls)
        found[acts] += (self.D[some][acts][:, None] @ response.controls[step[acts]])[:, 0]
        return found


@dataclass(frozen=True, eq=False)
class Response:
    """How states (T, n, N) and controls (T - 1, m, N) answer to the N = (T - 1) m whitened v.

    With u_t = k_t - K_t xi_t + v_t, W_t = L Lᵀ and z_t = Lᵀ v_t the cost is its least plus |z|².
    """

    states: np.ndarray
    controls: np.ndarray

    @classmethod
    def of(cls, feedback: Feedback) -> "Response":
        """That of the system under the unconstrained law."""
        T, m, n = feedback.gain.shape
        assert feedback.system is not None and feedback.curvature is not None
        A, B = feedback.system.over(T - 1)
        whitening = np.linalg.inv(np.linalg.cholesky(feedback.curvature[:-1])).mT
        states, controls = np.zeros((T, n, (T - 1) * m)), np.zeros((T - 1, m, (T - 1) * m))
        for t in range(T - 1):
            controls[t] = -feedback.gain[t] @ states[t]
            controls[t, :, m * t : m * (t + 1)] += whitening[t]
            states[t + 1] = A[t] @ states[t] + B[t] @ controls[t]
        return cls(states, controls)

    def plan(self, nominal: Plan, z: np.ndarray) -> Plan:
        """The plan for z (N,)."""
        return Plan(nominal.states + self.states @ z, nominal.controls + self.controls @ z)
