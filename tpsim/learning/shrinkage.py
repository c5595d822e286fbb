"""Shrinkage of what a mixture learned from few demonstrations: equal spread in all directions.

A component sees many samples but few demonstrations, and the samples of one demonstration are no
independent evidence: M demonstrations spread around their mean with M - 1 degrees of freedom,
however densely they are sampled. With M = 2 or 3 a covariance is almost singular in some
direction of space, and a product over frames believes that direction. Shrinkage towards equal
spread in all directions takes away as much of this shape as M demonstrations cannot support.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tpsim.border import Count, Number, border
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian, inverse_spd, symmetric
from tpsim.learning.subspace import FULL
from tpsim.learning.tp_gmm import TPGMM


@border
def shrink_directions(
    model: TPGMM, demonstrations: Count, given: Sequence[Number] = (0,), blocks: Count = 1
) -> TPGMM:
    """Shrink the covariance of the outputs, given the inputs, towards equal spread in space.

    Means, input covariances and the slopes of the regression (Eq. 14) stay. The outputs are
    ``blocks`` C vectors of one space of d dimensions, such as position, velocity and
    acceleration. Their conditional covariance S (Eq. 15), in every component and frame, becomes
    (1 - rho) S + rho T with T = S_C (x) I_d, where S_C (C, C) is the mean of S over the d
    directions: what position says of velocity stays, and no direction is special. The weight rho
    is that of :func:`oracle_weight` for the mean of S over the blocks, each scaled by S_C: the
    more demonstrations, the more of the shape is believed. Everything follows rotations of the
    frame and units of the blocks.

    Parameters
    ----------
    model : TPGMM
        Over inputs and outputs; the d directions share one unit, such as metres.
    demonstrations : int
        Number M of demonstrations that the model was fitted to.
    given : sequence of int
        Input dimensions: time by default, () where there is no input.
    blocks : int
        Number C of vectors one after the other in the outputs: 3 for [x, dx, ddx].

    Raises
    ------
    ArgumentError
        No demonstration, or dimensions that leave no output or do not make C equal blocks.
    """
    inputs = np.array(given, int)
    for dim in model.dims:
        size = dim - len(inputs)
        if size < 1 or size % blocks or not all(0 <= i < dim for i in inputs):
            raise ArgumentError(
                f"given is {tuple(given)} and blocks {blocks}; a frame of dimension {dim} needs "
                f"inputs out of 0..{dim - 1}, and outputs that make equal blocks"
            )
    frames = tuple(_shrunk(frame, demonstrations, inputs, blocks) for frame in model.frames)
    return replace(model, frames=frames, structure=FULL, memory=None)


def oracle_weight(covariance: NDArray, count: int) -> NDArray:
    """Weight rho (...) of the isotropic target for covariances (..., p, p) of few samples.

    The oracle approximating shrinkage of [Chen, Wiesel, Eldar and Hero 2010], their (23): the
    weight of least expected square error for normal samples, as far as the covariance itself
    can tell. One where the covariance is isotropic; at least 2 / count in the plane.
    """
    p = covariance.shape[-1]
    trace_squared = np.trace(covariance, axis1=-2, axis2=-1) ** 2
    squares = np.einsum("...ij,...ij->...", covariance, covariance)
    numerator = (1 - 2 / p) * squares + trace_squared
    denominator = (count + 1 - 2 / p) * (squares - trace_squared / p)
    whole = denominator <= numerator
    return np.where(whole, 1.0, numerator / np.where(whole, 1.0, denominator))


def _shrunk(frame: Gaussian, count: int, inputs: NDArray, blocks: int) -> Gaussian:
    Sigma = frame.covariance.copy()
    outputs = np.setdiff1d(np.arange(frame.dim), inputs)
    of_outputs = (slice(None), outputs[:, None], outputs)
    S = Sigma[of_outputs]
    explained = np.zeros_like(S)
    if len(inputs):
        cross = Sigma[:, outputs[:, None], inputs]
        among = inverse_spd(Sigma[:, inputs[:, None], inputs], "input covariance")
        explained = symmetric(cross @ among @ cross.mT)
    Sigma[of_outputs] = _towards_equal_spread(S - explained, count, blocks) + explained
    return Gaussian(frame.mean, Sigma)


def _towards_equal_spread(S: NDArray, count: int, blocks: int) -> NDArray:
    """Shrink covariances (K, C d, C d) of C vectors in d dimensions."""
    d = S.shape[-1] // blocks
    parted = S.reshape(-1, blocks, d, blocks, d)
    of_blocks = np.einsum("kcaea->kce", parted) / d
    in_space = np.einsum(
        "kce,kceab->kab",
        inverse_spd(of_blocks, "covariance of the blocks"),
        parted.transpose(0, 1, 3, 2, 4),
    )
    rho = oracle_weight(symmetric(in_space), count)[:, None, None]
    target = np.einsum("kce,ab->kcaeb", of_blocks, np.eye(d)).reshape(S.shape)
    return (1 - rho) * S + rho * target
