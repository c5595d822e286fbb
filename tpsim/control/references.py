"""What a sequence of states asks for, in one coordinate system or several: Eqs (35) and (38)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from tpsim.checks import entries, several
from tpsim.errors import ArgumentError
from tpsim.frame import Frame, frames_or_none
from tpsim.gaussian import Gaussian
from tpsim.learning.markov import visited


def state_references(
    gaussians: Sequence[Gaussian] | Gaussian,
    sequences: Sequence[ArrayLike],
    frames: Sequence[Frame] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Means and precisions of P coordinate systems, each along states of its own (Eqs 35, 38).

    Where Gaussians are over position and velocity both are references, with the precision that the
    model found in them; :func:`lqt` and :func:`constrained_lqt` take what this returns.

    Parameters
    ----------
    gaussians : sequence of Gaussian (K_j, d_j)
        What the states of each coordinate system j look like, such as those of a GMM, HMM, or HSMM
        or the frames of a TP-GMM; their numbers K_j may differ.
    sequences : sequence of (T,)
        States s_1 ... s_T in each, integers 0 ... K_j - 1: of its own HSMM, or the same for all.
    frames : sequence of Frame, optional
        From the coordinates of each to common ones; lifted by ``with_derivatives(1)`` where states
        hold velocities. Constant, or moving over the T steps. The common ones by default.

    Returns
    -------
    means, precisions : (P, T, n), (P, T, n, n)

    Raises
    ------
    ArgumentError
        A sequence that visits no state or one that is not there, or other lengths or sizes.
    """
    some = several("gaussians", gaussians, Gaussian, "such as model.gaussians")
    parts = entries("sequences", sequences)
    maps: list[Frame | None] = [None] * len(some)
    if frames is not None:
        maps = frames_or_none("frames", frames)
    if not some or not len(some) == len(parts) == len(maps):
        raise ArgumentError(
            f"there are {len(some)} coordinate systems, {len(parts)} sequences of states and "
            f"{len(maps)} frames; give one of each for every coordinate system"
        )
    means, precisions = [], []
    for j, (gaussian, states, frame) in enumerate(zip(some, parts, maps, strict=True)):
        if gaussian.mean.ndim != 2:
            raise ArgumentError(
                f"gaussians[{j}] have means of shape {gaussian.mean.shape}; give (K, d)"
            )
        if frame is not None and frame.local_dim != gaussian.mean.shape[-1]:
            raise ArgumentError(
                f"frames[{j}] is of {frame.local_dim} local coordinates and gaussians[{j}] "
                f"{gaussian.mean.shape[-1]}; give as many"
            )
        chosen = visited(f"sequences[{j}]", states, len(gaussian.mean))
        mean, precision = gaussian.mean[chosen], gaussian.precision[chosen]
        if frame is not None:
            inverse = frame.inverse
            mean, precision = frame.to_common(mean), inverse.mT @ precision @ inverse
        means.append(mean)
        precisions.append(0.5 * (precision + precision.mT))
    if len({mean.shape for mean in means}) > 1:
        raise ArgumentError(
            f"the coordinate systems have means of shapes {[mean.shape for mean in means]}; all "
            "need as many steps, and as many common coordinates"
        )
    return np.array(means), np.array(precisions)
