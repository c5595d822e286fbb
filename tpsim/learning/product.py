"""Product of Gaussians over frames (Eqs 5-6): in information form, or with a ridge."""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.frame import Frame, pseudoinverse
from tpsim.gaussian import Gaussian, add_ridge, inverse_spd, symmetric

UNSEEN = 1e-8  # relative length below which a direction counts as seen by no frame

Stack = Callable[[tuple[int, ...]], tuple[np.ndarray, np.ndarray]]
"""Means (G, K, d) and precisions (G, K, d, d) that the model learned in the frames asked for."""


def product_of_frames(
    stack: Stack, frames: Sequence[Frame | None], prior: Gaussian | None
) -> Gaussian:
    """Gaussians (..., K, D) whose precision is the sum over frames of (A^+)' Sigma^-1 A^+.

    ``prior`` is one more factor, in common coordinates; without it every direction must be seen
    by some frame.
    """
    precision = information = 0.0
    maps = []
    for group in _alike(frames):
        A = np.array([frames[j].A for j in group])
        b = np.array([frames[j].b for j in group])
        inverse = pseudoinverse(A)
        maps.append((A, inverse))
        mean, local = (_with_leading(part, A.ndim - 3) for part in stack(group))
        weighted = inverse.mT[..., None, :, :] @ local
        precision = precision + (weighted @ inverse[..., None, :, :]).sum(0)
        target = mean + np.matmul(inverse, b[..., None]).mT
        information = information + (weighted @ target[..., None]).sum(0)
    if prior is not None:
        precision = precision + prior.precision
        information = information + prior.precision @ prior.mean[..., None]
    elif not any(_determines(A, inverse) for A, inverse in maps):
        _check_all_seen([inverse for _, inverse in maps])
    covariance = inverse_spd(precision, "sum of the frames' precisions")
    return Gaussian.trusted((covariance @ information)[..., 0], covariance)


def product_with_ridge(
    local: Sequence[Gaussian], frames: Sequence[Frame | None], ridge: float, prior: Gaussian | None
) -> Gaussian:
    """Gaussians (..., K, D) from every A Sigma A' + rho I, as the tutorial's own code has it."""
    if not (np.isfinite(ridge) and ridge > 0):
        raise ArgumentError(f"ridge is {ridge}; it must be a positive number, or None")
    precision = information = 0.0
    factors = [
        (
            (frame.A[..., None, :, :] @ gaussian.mean[..., None]) + frame.b[..., None, :, None],
            add_ridge(_congruence(frame.A[..., None, :, :], gaussian.covariance), ridge),
        )
        for gaussian, frame in zip(local, frames, strict=True)
        if frame is not None
    ]
    if prior is not None:
        factors.append((prior.mean[..., None], prior.covariance))
    for mean, covariance in factors:
        more = inverse_spd(covariance, "covariance in a frame")
        precision, information = precision + more, information + more @ mean
    covariance = inverse_spd(precision, "sum of the frames' precisions")
    return Gaussian.trusted((covariance @ information)[..., 0], covariance)


def _congruence(A: np.ndarray, Sigma: np.ndarray) -> np.ndarray:
    return symmetric(A @ Sigma @ A.mT)


def _alike(frames: Sequence[Frame | None]) -> list[tuple[int, ...]]:
    """Frames that are observed, those with matrices of the same shape together."""
    groups: dict[tuple, list[int]] = {}
    for j, frame in enumerate(frames):
        if frame is not None:
            groups.setdefault(frame.A.shape, []).append(j)
    return [tuple(group) for group in groups.values()]


def _with_leading(part: np.ndarray, axes: int) -> np.ndarray:
    """Make room for the frames' leading axes between the frame axis and the components."""
    return part.reshape(len(part), *(1,) * axes, *part.shape[1:]) if axes else part


def _determines(A: np.ndarray, inverse: np.ndarray) -> bool:
    """Whether at every step one frame sees all directions: the rank of A is the trace of A A^+."""
    overlap, D = A * inverse.mT, A.shape[-2]
    if overlap.sum() > overlap.size // A.shape[-1] - 0.5:
        return True  # all frames of all steps see everything
    return bool((overlap.sum((-2, -1)) > D - 0.5).any(0).all())


def _check_all_seen(inverses: Sequence[np.ndarray]) -> None:
    """Raise an ArgumentError that names a direction which no frame sees."""
    if not inverses:
        raise ArgumentError("no frame was given and no prior; give at least one of them")
    leading = np.broadcast_shapes(*(inverse.shape[1:-2] for inverse in inverses))
    rows = [
        np.broadcast_to(one, (*leading, *one.shape[-2:])) for inverse in inverses for one in inverse
    ]
    views = np.concatenate(rows, axis=-2)
    units = np.abs(views).max(-2, keepdims=True)
    units[units == 0] = 1.0
    _, lengths, directions = np.linalg.svd(views / units)
    least = np.zeros(leading) if views.shape[-2] < views.shape[-1] else lengths[..., -1]
    unseen = least <= UNSEEN * lengths[..., 0]
    if unseen.any():
        step = tuple(int(i) for i in np.argwhere(unseen)[0])
        direction = directions[step][-1] / units[step][0]
        direction = np.round(direction / np.linalg.norm(direction), 3) + 0.0  # no -0.0
        where = f" at step {step[0]}" if step else ""
        raise ArgumentError(
            f"no frame determines the direction {direction.tolist()}{where} of the common space; "
            "give a weak prior Gaussian, adapt(frames, prior=...), or observe one more frame"
        )
