"""Product of Gaussians over frames (Eqs 5-6): in information form, or with a ridge."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import LARGEST, entries, finite_array, instance, number
from tpsim.errors import ArgumentError
from tpsim.frame import Frame, plain_inverse, pseudoinverse
from tpsim.gaussian import Gaussian, add_ridge, faded, inverse_spd, symmetric

_ZERO = np.zeros(1)
UNSEEN = 1e-8  # relative length below which a direction counts as seen by no frame

Uncertainty = Sequence[np.ndarray | None] | None
"""Covariance (..., 1 or K, D, D) of where each frame is, in common coordinates; None: exactly."""

Stack = Callable[[tuple[int, ...]], tuple[np.ndarray, np.ndarray]]
"""Means (G, K, d) and precisions (G, K, d, d) that the model learned in the frames asked for."""


@np.errstate(over="ignore", invalid="ignore")
def product_of_frames(
    stack: Stack,
    frames: Sequence[Frame | None],
    prior: Gaussian | None,
    uncertainty: Uncertainty = None,
) -> Gaussian:
    """Gaussians (..., K, D) whose precision is the sum over frames of (A^+)' Sigma^-1 A^+.

    ``prior`` is one more factor, in common coordinates; without it every direction must be seen
    by some frame.
    """
    precisions, informations = [], []
    maps: list[tuple[np.ndarray, np.ndarray]] = []
    origin, determined = _ZERO, False
    for group, members in _alike(frames):
        A = np.array([frame.A for frame in members])
        b = np.array([frame.b for frame in members])
        inverse = plain_inverse(A)
        determined |= inverse is not None
        if inverse is None:
            inverse = pseudoinverse(A)
        means, inverses = stack(group)
        if not maps:  # a point near the result: far from zero, sums would lose their digits
            origin = _near(members[0], means[0, 0])
        maps.append((A, inverse))
        mean, local = (_with_leading(part, A.ndim - 3) for part in (means, inverses))
        weighted = inverse.mT[..., None, :, :] @ local
        precision = weighted @ inverse[..., None, :, :]
        target = mean + np.matmul(inverse, (b - origin)[..., None]).mT
        information = weighted @ target[..., None]
        for k, unsure in enumerate(uncertainty[j] for j in group) if uncertainty else ():
            if unsure is not None:
                left = faded(precision[k], unsure)
                precision[k], information[k] = symmetric(left @ precision[k]), left @ information[k]
        precisions.append(precision.sum(0))
        informations.append(information.sum(0))
    if prior is not None:
        precisions.append(prior.precision)
        informations.append(prior.precision @ (prior.mean - origin)[..., None])
    elif not determined and not any(_determines(A, inverse) for A, inverse in maps):
        _check_all_seen([inverse for _, inverse in maps])
    covariance = inverse_spd(_sum(precisions), "sum of the frames' precisions")
    mean = (covariance @ _sum(informations))[..., 0] + origin
    if not np.isfinite(mean.sum()):
        raise ArgumentError(
            "frames ask for means beyond all numbers; give matrices A of entries nearer to one"
        )
    return Gaussian.trusted(mean, covariance)


def _sum(parts: list[np.ndarray]) -> np.ndarray:
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total


def _near(frame: Frame, mean: np.ndarray) -> np.ndarray:
    """Where a mean (d,) lies in common coordinates, (D,); at the first step of a moving frame."""
    A, b = frame.A, frame.b
    if b.ndim > 1:
        first = (0,) * (b.ndim - 1)
        A, b = A[first], b[first]
    near = A @ mean + b
    return near if all(-LARGEST < x < LARGEST for x in near.tolist()) else _ZERO


def product_with_ridge(
    local: Sequence[Gaussian],
    frames: Sequence[Frame | None],
    ridge: float,
    prior: Gaussian | None,
    uncertainty: Uncertainty = None,
) -> Gaussian:
    """Gaussians (..., K, D) from every A Sigma A' + rho I, as the tutorial's own code has it."""
    ridge = number("ridge", ridge, above=0)
    precision, information = _ZERO, _ZERO
    factors = [
        (
            (frame.A[..., None, :, :] @ gaussian.mean[..., None]) + frame.b[..., None, :, None],
            add_ridge(_congruence(frame.A[..., None, :, :], gaussian.covariance), ridge)
            + (_ZERO if unsure is None else unsure),
        )
        for gaussian, frame, unsure in zip(
            local, frames, uncertainty or [None] * len(frames), strict=True
        )
        if frame is not None
    ]
    if prior is not None:
        factors.append((prior.mean[..., None], prior.covariance))
    origin = factors[0][0].reshape(-1, factors[0][0].shape[-2], 1)[0]
    for mean, covariance in factors:
        more = inverse_spd(covariance, "covariance in a frame")
        precision, information = precision + more, information + more @ (mean - origin)
    covariance = inverse_spd(precision, "sum of the frames' precisions")
    return Gaussian.trusted((covariance @ information + origin)[..., 0], covariance)


def checked_frames(
    frames: Sequence[Frame | None], sizes: Sequence[int], prior: Gaussian | None
) -> list[Frame | None]:
    """Frames for a model whose own see so many dimensions, or an ArgumentError."""
    given = [frames] if isinstance(frames, Frame) else entries("frames", frames, tables=False)
    if len(given) != len(sizes):
        raise ArgumentError(
            f"{len(given)} frames were given; the model has {len(sizes)} (None where "
            "one is not observed)"
        )
    dims = {instance("prior", prior, Gaussian).dim} if prior is not None else set()
    moving: set[tuple[int, ...]] = set()
    found: list[Frame | None] = []
    for j, (frame, d) in enumerate(zip(given, sizes, strict=True)):
        if frame is None:
            found.append(None)
            continue
        if not isinstance(frame, Frame):
            frame = instance(f"frame {j}", frame, Frame, "give Frame(A, b)")
        found.append(frame)
        *leading, D, local = frame.A.shape
        if local != d:
            raise ArgumentError(
                f"frame {j} has A of shape {frame.A.shape}; the model asks for (..., D, {d})"
            )
        dims.add(D)
        if leading:
            moving.add(tuple(leading))
    if len(dims) != 1:
        raise ArgumentError(
            f"the frames lead to common dimensions {sorted(dims)}; at least one frame must "
            "be given, and all must agree"
        )
    if len(moving) > 1:
        raise ArgumentError(f"the frames move in steps of {sorted(moving)}; all must agree")
    return found


def checked_uncertainty(
    given: Sequence[ArrayLike | None] | None, frames: Sequence[Frame | None], components: int
) -> Uncertainty:
    """Covariances of where frames are, (1 or K, D, D) each; None where all are exactly known.

    Raises
    ------
    ArgumentError
        Another number than there are frames, wrong shapes, or what is no covariance.
    """
    if given is None:
        return None
    parts = entries("uncertainty", given, tables=False)
    if len(parts) != len(frames):
        raise ArgumentError(
            f"uncertainty has {len(parts)} entries; give one for each of {len(frames)} frames, "
            "None where it is exactly known"
        )
    D = next((frame.dim for frame in frames if frame is not None), 0)
    found: list[np.ndarray | None] = []
    for j, part in enumerate(parts):
        if part is None or frames[j] is None:
            found.append(None)
            continue
        name = f"uncertainty[{j}]"
        covariance = finite_array(name, part)
        if covariance.shape not in ((D, D), (components, D, D)):
            raise ArgumentError(
                f"{name} has shape {covariance.shape}; give ({D}, {D}) or ({components}, {D}, {D})"
            )
        size = np.abs(covariance).max(initial=0.0)
        skew = np.abs(covariance - covariance.mT).max(initial=0.0)
        if skew > 1e-8 * size or np.linalg.eigvalsh(covariance).min() < -1e-8 * size:
            raise ArgumentError(f"{name} is no covariance: symmetric, without negative variances")
        found.append(covariance.reshape(-1, D, D))
    return found


def _congruence(A: np.ndarray, Sigma: np.ndarray) -> np.ndarray:
    return symmetric(A @ Sigma @ A.mT)


def _alike(frames: Sequence[Frame | None]) -> list[tuple[tuple[int, ...], list[Frame]]]:
    """Frames that are observed, by number, those with matrices of the same shape together."""
    groups: dict[tuple[int, ...], tuple[list[int], list[Frame]]] = {}
    for j, frame in enumerate(frames):
        if frame is not None:
            numbers, members = groups.setdefault(frame.A.shape, ([], []))
            numbers.append(j)
            members.append(frame)
    return [(tuple(numbers), members) for numbers, members in groups.values()]


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
