"""Product over frames on manifolds (Eqs 5-6): rigid motions, then Gauss-Newton to common means."""

from collections.abc import Sequence

import numpy as np

from tpsim.checks import entries, instance, number
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.product import Stack
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.product import fused


def product_on(
    local: Sequence[Gaussian],
    frames: Sequence[Frame | None],
    ridge: float | None,
    prior: Gaussian | None,
    stack: Stack | None = None,
) -> RiemannianGaussian:
    """Gaussians (..., K) on the manifold of common coordinates, for frames (P) as they are now.

    ``stack`` says means and precisions of the frames asked for, where these are remembered.
    """
    group, members, manifold = _observed(local, frames)
    own = stack(group) if stack is not None else _stacked(local, group)
    means, precisions = _placed(manifold, *own, members)
    if ridge is not None:
        covariances = np.linalg.inv(precisions) + number("ridge", ridge, above=0) * np.eye(
            manifold.dim
        )
        precisions = np.linalg.inv(covariances)
    if prior is not None:
        if getattr(prior, "manifold", None) != manifold:
            raise ArgumentError(f"prior is not on the manifold of the frames, {manifold}")
        more = np.broadcast_to(prior.mean, means.shape[1:])[None]
        means = np.concatenate([means, more])
        more = np.broadcast_to(prior.precision, precisions.shape[1:])[None]
        precisions = np.concatenate([precisions, more])
    return RiemannianGaussian.trusted_on(manifold, *fused(manifold, means, precisions))


def placed(
    local: Sequence[RiemannianGaussian], frames: Sequence[Frame]
) -> tuple[np.ndarray, np.ndarray]:
    """Means (P, ..., K, width) and precisions (P, ..., K, dim, dim) in common coordinates."""
    group, members, manifold = _observed(local, frames)
    return _placed(manifold, *_stacked(local, group), members)


def _observed(
    local: Sequence[Gaussian], frames: Sequence[Frame | None]
) -> tuple[tuple[int, ...], list[Frame], Manifold]:
    """Frames that are observed, by number and themselves, and the one manifold they lead to."""
    given = [frames] if isinstance(frames, Frame) else entries("frames", frames, tables=False)
    if len(given) != len(local):
        raise ArgumentError(
            f"{len(given)} frames were given; the model has {len(local)} (None where one is not "
            "observed)"
        )
    group, members = [], []
    for j, frame in enumerate(given):
        if frame is not None:
            group.append(j)
            members.append(instance(f"frame {j}", frame, Frame, "give Frame(A, b)"))
    kinds = [getattr(local[j], "manifold", None) for j in group]
    manifold = kinds[0] if kinds else None
    if manifold is None or any(one is not manifold and one != manifold for one in kinds):
        names = dict.fromkeys(
            str(kind or f"R({local[j].dim})") for j, kind in zip(group, kinds, strict=True)
        )
        raise ArgumentError(
            f"the frames lead to {', '.join(names) or 'nothing'}; at least one frame must be "
            "given, and all must lead to one manifold"
        )
    return tuple(group), members, manifold


def _placed(
    manifold: Manifold, means: np.ndarray, precisions: np.ndarray, frames: Sequence[Frame]
) -> tuple[np.ndarray, np.ndarray]:
    """Means (P, ..., K, width) and precisions (P, ..., K, dim, dim) in common coordinates.

    Of those (P, K, ...) that frames (P) with leading axes (...) see.
    """
    # All frames at once: for matrices so small, every call costs more than what it computes.
    try:
        A, b = _alike([frame.A for frame in frames]), _alike([frame.b for frame in frames])
    except ValueError as error:
        raise ArgumentError(f"the frames have different shapes or steps ({error})") from error
    A, b = A[..., None, :, :], b[..., None, :]
    means, precisions = _with_room(means, b.ndim), _with_room(precisions, b.ndim + 1)
    mean, turn, rigid = manifold.moved(Frame.trusted(A, b), means)
    back = turn.mT if rigid else np.linalg.inv(turn)
    return mean, back.mT @ precisions @ back


def _stacked(local: Sequence[Gaussian], group: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Means and precisions of some Gaussians, (P, ...)."""
    members = [local[j] for j in group]
    return np.array([g.mean for g in members]), np.array([g.precision for g in members])


def _with_room(stack: np.ndarray, ndim: int) -> np.ndarray:
    """Arrays of the members, with leading axes of the frames between those and their own."""
    room = (1,) * (ndim - stack.ndim)
    return stack.reshape(len(stack), *room, *stack.shape[1:]) if room else stack


def _alike(arrays: list[np.ndarray]) -> np.ndarray:
    if any(array.shape != arrays[0].shape for array in arrays):
        return np.array(np.broadcast_arrays(*arrays))
    return np.array(arrays)
