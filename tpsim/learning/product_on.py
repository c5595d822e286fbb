"""Product over frames on manifolds (Eqs 5-6): rigid motions, then Gauss-Newton to common means."""

from collections.abc import Sequence

import numpy as np

from tpsim.checks import entries, instance, number
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.manifold.manifold import Manifold
from tpsim.manifold.product import fused


def product_on(
    local: Sequence[Gaussian],
    frames: Sequence[Frame | None],
    ridge: float | None,
    prior: Gaussian | None,
) -> RiemannianGaussian:
    """Gaussians (..., K) on the manifold of common coordinates, for frames (P) as they are now."""
    members = _observed(local, frames)
    manifold, means, precisions = _placed(members)
    if ridge is not None:
        covariances = np.linalg.inv(precisions) + number("ridge", ridge, above=0) * np.eye(
            manifold.dim
        )
        precisions = np.linalg.inv(covariances)
    if prior is not None:
        if getattr(prior, "manifold", None) != manifold:
            raise ArgumentError(f"prior is not on the manifold of the frames, {manifold}")
        own = np.broadcast_to(prior.mean, means.shape[1:])[None]
        means = np.concatenate([means, own])
        own = np.broadcast_to(prior.precision, precisions.shape[1:])[None]
        precisions = np.concatenate([precisions, own])
    return RiemannianGaussian.trusted_on(manifold, *fused(manifold, means, precisions))


def placed(
    local: Sequence[RiemannianGaussian], frames: Sequence[Frame]
) -> tuple[np.ndarray, np.ndarray]:
    """Means (P, ..., K, width) and precisions (P, ..., K, dim, dim) in common coordinates."""
    _, means, precisions = _placed(_observed(local, frames))
    return means, precisions


def _observed(
    local: Sequence[Gaussian], frames: Sequence[Frame | None]
) -> list[tuple[RiemannianGaussian, Frame]]:
    """Gaussians of the frames that are observed, on one manifold."""
    given = [frames] if isinstance(frames, Frame) else entries("frames", frames, tables=False)
    if len(given) != len(local):
        raise ArgumentError(
            f"{len(given)} frames were given; the model has {len(local)} (None where one is not "
            "observed)"
        )
    found = [
        (gaussian, instance(f"frame {j}", frame, Frame, "give Frame(A, b)"))
        for j, (frame, gaussian) in enumerate(zip(given, local, strict=True))
        if frame is not None
    ]
    kinds = {getattr(g, "manifold", None) for g, _ in found}
    if len(kinds) != 1 or None in kinds:
        names = dict.fromkeys(str(getattr(g, "manifold", f"R({g.dim})")) for g, _ in found)
        raise ArgumentError(
            f"the frames lead to {', '.join(names) or 'nothing'}; at least one frame must be "
            "given, and all must lead to one manifold"
        )
    return [
        (gaussian, frame) for gaussian, frame in found if isinstance(gaussian, RiemannianGaussian)
    ]


def _placed(
    members: Sequence[tuple[RiemannianGaussian, Frame]],
) -> tuple[Manifold, np.ndarray, np.ndarray]:
    """Means (P, ..., K, width) and precisions (P, ..., K, dim, dim) in common coordinates."""
    manifold = members[0][0].manifold
    # All frames at once: for matrices so small, every call costs more than what it computes.
    try:
        A, b = _stacked([frame.A for _, frame in members]), _stacked([f.b for _, f in members])
    except ValueError as error:
        raise ArgumentError(f"the frames have different shapes or steps ({error})") from error
    A, b = A[..., None, :, :], b[..., None, :]
    local, precision = (
        _with_room([getattr(g, name) for g, _ in members], b.ndim - extra)
        for name, extra in (("mean", 0), ("precision", -1))
    )
    mean, turn, rigid = manifold.moved(Frame.trusted(A, b), local)
    back = turn.mT if rigid else np.linalg.inv(turn)
    return manifold, mean, back.mT @ precision @ back


def _with_room(arrays: list[np.ndarray], ndim: int) -> np.ndarray:
    """Arrays of the members, with leading axes of the frames between those and their own."""
    stack = np.array(arrays)
    room = (1,) * (ndim - stack.ndim)
    return stack.reshape(len(stack), *room, *stack.shape[1:])


def _stacked(arrays: list[np.ndarray]) -> np.ndarray:
    if any(array.shape != arrays[0].shape for array in arrays):
        return np.array(np.broadcast_arrays(*arrays))
    return np.array(arrays)
