"""Regression with a task-parameterized mixture: before, after, or inside the product over frames.

The three orders share one conditional. Given the input t, the product over frames of component i
(Eqs 5-6) and the product of its regressions in every frame are the same Gaussian. What differs
is how much each component counts at t. In the product of the joint densities over [t, x] the
weight of component i becomes

    h_i(t)  ~  prior_i  N(t; mu_i, sigma_i^2)^P  x  density of the frames' disagreement at t:

a component moves to the time at which its frames agree, far from the demonstrations by more than
its own duration. See docs/time-pull.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tpsim.border import NotNegative, Number, border
from tpsim.checks import finite_array
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, add_ridge, match_moments
from tpsim.learning.gmm import GMM
from tpsim.learning.tp_gmm import TPGMM
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import Regression, gmr

Order = Literal["regression", "product", "held"]


@border
def tp_gmr(
    tpgmm: TPGMM,
    frames: Sequence[Frame | None],
    inputs: ArrayLike,
    given: Sequence[Number] = (0,),
    order: Order = "regression",
    *,
    ridge: NotNegative = 0.0,
) -> Gaussian:
    """Retrieve a movement from a TP-GMM over inputs and outputs in new frames, Eqs 5-6 and 13-20.

    Parameters
    ----------
    tpgmm
        Learned from data with the inputs in it, such as ``demonstration.with_time()``.
    frames
        P frames of the outputs, or lifted by :meth:`Frame.with_input`; None where one is not
        observed. Moving frames have a leading axis T.
    inputs
        (T, I) values of the inputs, or (T,) when there is one [s for time].
    given
        The I input dimensions.
    order
        ``"regression"``: regression in every frame, then the product over frames at equal input.
        ``"product"``: Eqs 5-6 first, then regression, as the tutorial's text and benchmarks; the
        frames may then pull components in time. ``"held"``: the product of every component with
        its input held where it was learned, then the mixture of the components.
    ridge
        Added to the diagonal of the output covariance (Eq. 8).

    Returns
    -------
    Gaussian with mean (T, O) and covariance (T, O, O).

    Raises
    ------
    ArgumentError
        Another number of frames, all of them None, shapes that do not fit, an unknown order, or
        a frame that changes the inputs where the order asks for equal ones.
    """
    _check(tpgmm, frames)
    inputs = finite_array("inputs", inputs)
    if inputs.ndim not in (1, 2) or not inputs.size:
        raise ArgumentError(f"inputs have shape {inputs.shape}; give (T, {len(given)}), T >= 1")
    if order == "product":
        lifted = [
            frame if frame is None or frame.local_dim == d else _lift(frame, given)
            for frame, d in zip(frames, tpgmm.dims, strict=True)
        ]
        return gmr(tpgmm.adapt(lifted), inputs, given, ridge=ridge)
    observed = [
        None if frame is None else _outputs(frame, dim, given)
        for frame, dim in zip(frames, tpgmm.dims, strict=True)
    ]
    views = [Regression.of(GMM(tpgmm.priors, local), given) for local in tpgmm.frames]
    if order == "regression":
        path = fuse_frames([view(inputs) for view in views], observed)
    else:
        path = _held(views, observed, inputs)
    return Gaussian.trusted(path.mean, add_ridge(path.covariance, ridge)) if ridge else path


def _held(
    views: Sequence[Regression], frames: Sequence[Frame | None], inputs: ArrayLike
) -> Gaussian:
    """Product over frames of every component, weighted as the inputs were learned."""
    modes = [view.mixture(inputs) for view in views]
    weights = np.mean(
        [h for (h, _), frame in zip(modes, frames, strict=True) if frame is not None], axis=0
    )
    steps, components = weights.shape
    flat = [
        Gaussian.trusted(
            local.mean.reshape(-1, local.dim), local.covariance.reshape(-1, local.dim, local.dim)
        )
        for _, local in modes
    ]
    repeated = [
        Frame(np.repeat(frame.A, components, 0), np.repeat(frame.b, components, 0))
        if frame is not None and frame.shape
        else frame
        for frame in frames
    ]
    product = fuse_frames(flat, repeated)
    D = product.dim
    shaped = Gaussian.trusted(
        product.mean.reshape(steps, components, D),
        product.covariance.reshape(steps, components, D, D),
    )
    return match_moments(weights, shaped)


def _check(tpgmm: TPGMM, frames: Sequence[Frame | None]) -> None:
    if len(frames) != len(tpgmm.frames):
        raise ArgumentError(
            f"{len(frames)} frames were given; the model has {len(tpgmm.frames)} (None where one "
            "is not observed)"
        )
    if all(frame is None for frame in frames):
        raise ArgumentError("all frames are None; at least one must be observed")


def _lift(frame: Frame, given: Sequence[int]) -> Frame:
    """Frame of the outputs with the inputs, which it leaves alone, at the dimensions given."""
    lifted = frame.with_input(len(given))
    inputs = list(given)
    rows, columns = (_inputs_first(inputs, size) for size in lifted.A.shape[-2:])
    A, b = np.empty_like(lifted.A), np.empty_like(lifted.b)
    A[..., rows[:, None], columns] = lifted.A
    b[..., rows] = lifted.b
    return Frame(A, b)


def _outputs(frame: Frame, dim: int, given: Sequence[int]) -> Frame:
    """Frame of the outputs alone, of a frame that may have been lifted."""
    inputs = list(given)
    if frame.local_dim == dim - len(inputs):
        return frame
    if frame.local_dim != dim or not all(0 <= i < min(frame.A.shape[-2:]) for i in inputs):
        raise ArgumentError(
            f"a frame has A of shape {frame.A.shape}; with inputs {tuple(given)} the model asks "
            f"for (D, {dim - len(inputs)}), or lifted by its inputs (D + {len(inputs)}, {dim})"
        )
    n = len(inputs)
    rows, columns = (_inputs_first(inputs, size) for size in frame.A.shape[-2:])
    A, b = frame.A[..., rows[:, None], columns], frame.b[..., rows]
    same = (A[..., :n, :n] == np.eye(n)).all() and not b[..., :n].any()
    if not same or A[..., :n, n:].any() or A[..., n:, :n].any():
        raise ArgumentError(
            "a frame changes the inputs, so that frames cannot be asked at equal input; give "
            'frames lifted by with_input(), or order="product"'
        )
    return Frame(A[..., n:, n:], b[..., n:])


def _inputs_first(inputs: list[int], size: int) -> NDArray:
    """Dimensions in the order inputs, outputs."""
    return np.array([*inputs, *(i for i in range(size) if i not in inputs)], int)
