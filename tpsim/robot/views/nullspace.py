"""What is left of a Jacobian in the nullspace of others, Eqs (42)-(44)."""

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg.lapack import dposv

from tpsim.robot.state import State

if TYPE_CHECKING:
    from tpsim.robot.views.view import View


@cache
def eye(size: int, factor: float = 1.0) -> np.ndarray:
    """Identity times a factor, made once: control loops ask for it often."""
    return factor * np.eye(size)


def stacked_rows(views: Sequence["View"], state: State) -> np.ndarray:
    """Jacobians (d, n) of several views, one upon the other, as far as a nullspace needs them."""
    if len(views) == 1:
        return views[0].rows(state)
    return np.concatenate([view.rows(state) for view in views])


def through_nullspace(J_second: np.ndarray, J: np.ndarray, damping: float) -> np.ndarray:
    """``J~ N`` (k, n) with ``N = I - J^T (J J^T + damping^2 I)^-1 J``, Eqs (42)-(44).

    By the normal equations of J (m, n): an SVD costs ten times as much.
    """
    gram = J.dot(J.T) + eye(len(J), damping**2)
    felt: np.ndarray = dposv(gram, J.dot(J_second.T))[1]
    return J_second - felt.T.dot(J)
