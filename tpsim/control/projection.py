"""Jacobian and nullspace operators as frames of the configuration space: Table 3, Eqs 39-44.

Each function returns a :class:`tpsim.Frame` whose A (n, d) and b (n,) map a local Gaussian to
joint space, q_hat = A mu + b, around the present posture q, so that ``TPGMM.adapt`` multiplies
joint, task and nullspace constraints in one space. Leading axes broadcast.

Options that all of them share

gain
    Fraction of the correction that one step makes; 1 is the equation as printed (the reference
    code uses 0.15 where the frames are re-computed at every step).
clip
    Largest norm of the error ``b_object - x`` [m, rad]; None leaves it as it is.
damping
    Singular value s of J [m/rad, rad/rad] below which it is inverted as s / damping², bounded
    and continuous through a singular posture; for loops that step straight to q_hat. It is zero
    by default because the product of frames damps by itself: near a singular posture J⁺ grows,
    but the information that the frame carries, Jᵀ Σ⁻¹ J, vanishes, and the other frames decide.

Undamped, singular values below ``CUTOFF`` count as zero, so A is bounded at any posture.
"""

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import affordable, finite_array, number, whole
from tpsim.errors import ArgumentError
from tpsim.frame import Frame

CUTOFF = 1e-3
"""Singular value of a Jacobian below which its task direction is lost [m/rad, rad/rad]."""


def pseudoinverse(J: ArrayLike, damping: float = 0.0) -> np.ndarray:
    """Right pseudo-inverse J⁺ (..., n, m) of a Jacobian (..., m, n), bounded at any posture."""
    J, damping = finite_array("J", J), number("damping", damping, least=0)
    if J.ndim < 2 or 0 in J.shape[-2:]:
        raise ArgumentError(f"J has shape {J.shape}; give (..., m, n), m and n at least 1")
    U, singular, Vt = np.linalg.svd(J, full_matrices=False)
    lost = singular < CUTOFF if damping == 0 else False
    inverted = np.where(lost, 0.0, singular) / np.maximum(singular, damping or CUTOFF) ** 2
    return Vt.mT @ (inverted[..., None] * U.mT)


def nullspace(J: ArrayLike, damping: float = 0.0) -> np.ndarray:
    """Nullspace projection N = I - J⁺ J (..., n, n)."""
    J = finite_array("J", J)
    inverse = pseudoinverse(J, damping)
    return np.eye(J.shape[-1]) - inverse @ J


def joint(n: int) -> Frame:
    """Joint-space constraint in a fixed frame, Eq. 39: A = I, b = 0, for n joints."""
    n = whole("n", n, least=1, hint="a joint frame needs at least one joint")
    affordable("n", n, n)
    return Frame(np.eye(n), np.zeros(n))


def absolute(
    J: ArrayLike,
    q: ArrayLike,
    x: ArrayLike,
    *,
    gain: float = 1.0,
    damping: float = 0.0,
) -> Frame:
    """Absolute task-space constraint, Eq. 40: A = J⁺, b = q - J⁺ x.

    Parameters
    ----------
    J : array (..., m, n)
        Jacobian of the task at q.
    q : array (..., n)
        Present posture [rad].
    x : array (..., m)
        Present task-space pose [m, rad].
    gain, damping : float
        See the module.

    Returns
    -------
    Frame
        A (..., n, m), b (..., n).
    """
    J, q, x = _checked(J, q, x)
    return _task_frame(number("gain", gain) * pseudoinverse(J, damping), q, -x)


def relative(
    J: ArrayLike,
    q: ArrayLike,
    x: ArrayLike,
    A_object: ArrayLike,
    b_object: ArrayLike,
    *,
    gain: float = 1.0,
    clip: float | None = None,
    damping: float = 0.0,
) -> Frame:
    """Task-space constraint relative to an object, Eq. 41: A = J⁺ A_O, b = q + J⁺ (b_O - x).

    Parameters
    ----------
    J, q, x : arrays (..., m, n), (..., n), (..., m)
        Jacobian, posture [rad] and pose [m, rad], as in :func:`absolute`.
    A_object : array (..., m, d)
        Orientation of the object in task space.
    b_object : array (..., m)
        Position of the object in task space [m, rad].
    gain, clip, damping : float
        See the module.

    Returns
    -------
    Frame
        A (..., n, d), b (..., n).
    """
    J, q, x = _checked(J, q, x)
    A_object, b_object = _object(A_object, b_object, J)
    error = _clipped(b_object - x, clip)
    return _task_frame(number("gain", gain) * pseudoinverse(J, damping), q, error, A_object)


def nullspace_joint(
    J: ArrayLike,
    q: ArrayLike,
    *,
    gain: float = 1.0,
    damping: float = 0.0,
) -> Frame:
    """Posture in the nullspace of a task, Eq. 42: A = N, b = J⁺ J q.

    With a gain k it reads A = k N, b = q - k N q.

    Parameters
    ----------
    J : array (..., m, n)
        Jacobian of the task that comes first.
    q : array (..., n)
        Present posture [rad].
    gain, damping : float
        See the module.

    Returns
    -------
    Frame
        A (..., n, n) of rank n - m, b (..., n).
    """
    J, q = _posture(J, q)
    return _task_frame(number("gain", gain) * nullspace(J, damping), q, -q)


def nullspace_absolute(
    J: ArrayLike,
    q: ArrayLike,
    J_other: ArrayLike,
    x_other: ArrayLike,
    *,
    gain: float = 1.0,
    damping: float = 0.0,
) -> Frame:
    """Absolute secondary task in the nullspace, Eq. 43: A = N J~⁺, b = q - N J~⁺ x~.

    Parameters
    ----------
    J : array (..., m, n)
        Jacobian of the task that comes first.
    q : array (..., n)
        Present posture [rad].
    J_other, x_other : arrays (..., k, n), (..., k)
        Jacobian and pose of the secondary task [m, rad].
    gain, damping : float
        See the module.

    Returns
    -------
    Frame
        A (..., n, k), b (..., n).
    """
    J, q = _posture(J, q)
    J_other, q, x_other = _checked(J_other, q, x_other, "_other")
    return _task_frame(number("gain", gain) * _secondary(J, J_other, damping), q, -x_other)


def nullspace_relative(
    J: ArrayLike,
    q: ArrayLike,
    J_other: ArrayLike,
    x_other: ArrayLike,
    A_object: ArrayLike,
    b_object: ArrayLike,
    *,
    bend: float | None = None,
    gain: float = 1.0,
    clip: float | None = None,
    damping: float = 0.0,
) -> Frame:
    """Secondary task relative to an object, Eq. 44: A = N J~⁺ A_O, b = q + N J~⁺ (b_O - x~).

    As printed it comes to rest where N J~⁺ e = 0, which is not where the error e = b_O - x~ is
    least, that is N J~ᵀ e = 0. With ``bend`` the lift is a Newton step of the least error,
    N J~ᵀ (J~ N J~ᵀ + bend ‖e‖ I)⁻¹ instead of N J~⁺, and rests where it should for any bend.

    Parameters
    ----------
    J, q, J_other, x_other : arrays (..., m, n), (..., n), (..., k, n), (..., k)
        As in :func:`nullspace_absolute`.
    A_object, b_object : arrays (..., k, d), (..., k)
        Orientation and position of the object of the secondary task.
    bend : float, optional
        Curvature of the way of what moves [m/rad²]: the length of a link. As printed without.
    gain, clip, damping : float
        See the module; with ``bend`` at least ``CUTOFF`` dampens.

    Returns
    -------
    Frame
        A (..., n, d), b (..., n).
    """
    J, q = _posture(J, q)
    J_other, q, x_other = _checked(J_other, q, x_other, "_other")
    A_object, b_object = _object(A_object, b_object, J_other)
    error = _clipped(b_object - x_other, clip)
    if bend is None:
        lift = _secondary(J, J_other, damping)
    else:
        lift = _least(J, J_other, error, number("bend", bend, least=0), damping)
    return _task_frame(number("gain", gain) * lift, q, error, A_object)


def _secondary(J: np.ndarray, J_other: np.ndarray, damping: float) -> np.ndarray:
    """N(J) J_other⁺: the part of a secondary motion that the first task does not feel."""
    return nullspace(J, damping) @ pseudoinverse(J_other, damping)


def _least(
    J: np.ndarray, J_other: np.ndarray, error: np.ndarray, bend: float, damping: float
) -> np.ndarray:
    """The lift of a secondary task that comes nearest to its goal: N J~ᵀ (J~ N J~ᵀ + s I)⁻¹."""
    free = J_other @ nullspace(J, damping)
    s = max(damping, CUTOFF) ** 2 + bend * np.linalg.norm(error, axis=-1)
    gram = free @ free.mT + s[..., None, None] * np.eye(free.shape[-2])
    return np.linalg.solve(gram, free).mT


def _task_frame(
    lift: np.ndarray, q: np.ndarray, error: np.ndarray, A_object: np.ndarray | None = None
) -> Frame:
    """Frame of joint displacements lift (A_object mu + error) from the posture q."""
    A = lift if A_object is None else lift @ A_object
    b = q + (lift @ error[..., None])[..., 0]
    if A.shape[:-2] == b.shape[:-1]:
        return Frame.trusted(A, b)
    return Frame(A, b)


def _object(
    A_object: ArrayLike, b_object: ArrayLike, J: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Orientation (..., m, d) and position (..., m) of an object, after comparison with J."""
    A, b = finite_array("A_object", A_object), finite_array("b_object", b_object)
    m = J.shape[-2]
    if A.ndim < 2 or A.shape[-2] != m or b.shape[-1:] != (m,):
        raise ArgumentError(
            f"A_object has shape {A.shape} and b_object {b.shape}; with this J they must be "
            f"(..., {m}, d) and (..., {m})"
        )
    return A, b


def _clipped(error: np.ndarray, clip: float | None) -> np.ndarray:
    """The error, shortened to the norm ``clip`` without turning it."""
    if clip is None:
        return error
    clip = number("clip", clip, above=0)
    norm = np.linalg.norm(error, axis=-1, keepdims=True)
    return error * (clip / np.maximum(norm, clip))


def _posture(J: ArrayLike, q: ArrayLike, name: str = "J") -> tuple[np.ndarray, np.ndarray]:
    """The Jacobian and the posture, after comparing the sizes of the configuration."""
    J, q = finite_array(name, J), finite_array("q", q)
    if J.ndim < 2 or q.ndim < 1 or J.shape[-1] != q.shape[-1]:
        raise ArgumentError(
            f"{name} has shape {J.shape} and q {q.shape}; give (..., m, n) and (..., n)"
        )
    return J, q


def _checked(
    J: ArrayLike, q: ArrayLike, x: ArrayLike, other: str = ""
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The arguments as arrays, after comparing the sizes of task and configuration."""
    J, q = _posture(J, q, f"J{other}")
    x = finite_array(f"x{other}", x)
    if x.ndim < 1 or x.shape[-1] != J.shape[-2]:
        raise ArgumentError(
            f"J{other} has shape {J.shape} and x{other} {x.shape}; give (..., m, n) and (..., m)"
        )
    return J, q, x
