"""Regression with a task-parameterized mixture: before, after, or inside the product over frames.

The orders share one conditional. Given the input t, the product over frames of component i
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
from tpsim.gaussian import Gaussian, add_ridge, inverse_spd, match_moments
from tpsim.learning.gmm import GMM
from tpsim.learning.product_on import product_on
from tpsim.learning.tp_gmm import TPGMM
from tpsim.manifold.gaussian import RiemannianGaussian
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import Regression, gmr

Order = Literal["regression", "product", "held", "pooled"]


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
        its input held where it was learned, then the mixture of the components. ``"pooled"``: as
        regression, but every frame adds up the precisions of its components instead of matching
        the moments of their mixture, x minimising the expected cost
        ``sum_i h_i (x - x_i)^T Lambda_i (x - x_i)``: a precise component is not drowned by a vague
        one, and the covariance is too narrow for a distribution.
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
    if any(type(local) is not Gaussian for local in tpgmm.frames):
        return _on_manifolds(tpgmm, frames, inputs, given, order, ridge)
    if order == "product":
        lifted = [
            frame if frame is None or frame.local_dim == d else _lift(frame, given)
            for frame, d in zip(frames, tpgmm.dims, strict=True)
        ]
        for frame in lifted:
            if frame is not None and frame.A.shape[-2] <= len(given):
                raise ArgumentError(
                    f"frames: A of shape {frame.A.shape} leaves no output beside the inputs {given}"
                    "; give frames of the outputs, or lifted by with_input()"
                )
        return gmr(tpgmm.adapt(lifted), inputs, given, ridge=ridge)
    seen = [(frame, local) for frame, local in zip(frames, tpgmm.frames, strict=True) if frame]
    observed = [_outputs(frame, local.dim, given) for frame, local in seen]
    views = [Regression.of(GMM(tpgmm.priors, local), given) for _, local in seen]
    path = match_moments(*_fused(*at_equal_input(views, inputs, order), observed))
    return Gaussian.trusted(path.mean, add_ridge(path.covariance, ridge)) if ridge else path


def _on_manifolds(
    tpgmm: TPGMM,
    frames: Sequence[Frame | None],
    inputs: NDArray,
    given: Sequence[int],
    order: Order,
    ridge: float,
) -> Gaussian:
    """The same on manifolds: rigid motions of the outputs, products by Gauss-Newton."""
    if order not in ("regression", "product"):
        raise ArgumentError(f"order is {order!r}; on manifolds give 'regression' or 'product'")
    if order == "product":
        return gmr(tpgmm.adapt(frames), inputs, tuple(given), ridge=ridge)
    views = [gmr(GMM(tpgmm.priors, local), inputs, tuple(given)) for local in tpgmm.frames]
    moving = any(frame is not None and frame.shape for frame in frames)
    path = product_on([view[:, None] for view in views] if moving else views, frames, None, None)
    if moving:
        path = path[:, 0]
    covariance = add_ridge(path.covariance, ridge)
    return RiemannianGaussian.trusted_on(path.manifold, path.mean, covariance)


def at_equal_input(
    views: Sequence[Regression], inputs: ArrayLike, order: Order
) -> tuple[NDArray, list[Gaussian]]:
    """What every frame retrieves before their product, in the orders that hold the inputs.

    Parameters
    ----------
    views
        The model's regression in each of P frames.
    inputs
        (T, I), or (T,) when there is one.
    order
        ``"regression"``, ``"pooled"``: one Gaussian a frame, with all components in it.
        ``"held"``: one for every component, which counts as in the frames' own regressions.

    Returns
    -------
    weights (T, K) of the products, and P Gaussians (T, K, d_j); K is 1 unless held.
    """
    if order in ("regression", "pooled"):
        single = [
            view(inputs) if order == "regression" else _pooled(view, inputs) for view in views
        ]
        local = [
            Gaussian.trusted(g.mean[..., None, :], g.covariance[..., None, :, :]) for g in single
        ]
        return np.ones(local[0].mean.shape[:-1]), local
    modes = [view.mixture(inputs) for view in views]
    return np.mean([h for h, _ in modes], axis=0), [local for _, local in modes]


def _pooled(view: Regression, inputs: ArrayLike) -> Gaussian:
    """Logarithmic pool (T, d) of a frame's components: the product of N_i^h_i, normalised."""
    weights, local = view.mixture(inputs)
    precision = inverse_spd(view.covariance, "covariance of a component")
    covariance = inverse_spd(np.einsum("tk,kij->tij", weights, precision), "pooled precision")
    information = np.einsum("tk,kij,tkj->ti", weights, precision, local.mean)
    return Gaussian.trusted(np.einsum("tij,tj->ti", covariance, information), covariance)


def _fused(
    weights: NDArray, views: Sequence[Gaussian], frames: Sequence[Frame]
) -> tuple[NDArray, Gaussian]:
    """Weights, and the product over frames (T, K, D) of what each retrieved (T, K, d_j)."""
    steps, components = weights.shape
    flat = [
        Gaussian.trusted(
            local.mean.reshape(-1, local.dim), local.covariance.reshape(-1, local.dim, local.dim)
        )
        for local in views
    ]
    repeated = [
        Frame(np.repeat(frame.A, components, 0), np.repeat(frame.b, components, 0))
        if frame.shape
        else frame
        for frame in frames
    ]
    product = fuse_frames(flat, repeated)
    D = product.dim
    return weights, Gaussian.trusted(
        product.mean.reshape(steps, components, D),
        product.covariance.reshape(steps, components, D, D),
    )


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
