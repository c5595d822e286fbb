"""What frames may do to the points of a manifold."""

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.manifold.charts import Charts
from tpsim.manifold.unit import off_orthonormal

RIGID = 1e-9
"""How far A A' may be off the identity where lengths are kept."""


def check_rigid(work: Charts, A: np.ndarray) -> float:
    """How far a frame's A (..., n, n) is off a rotation or reflection; ArgumentError if far."""
    if A.shape[-1] != A.shape[-2]:
        raise ArgumentError(
            f"A has shape {A.shape}; frames of {work} are square: what not all frames see in "
            "full is for a TPGMM in R^n"
        )
    off = off_orthonormal(A)
    if work.flat:
        if (np.abs(np.linalg.det(A)) < 1e-12 * np.abs(A).max((-2, -1)) ** A.shape[-1]).any():
            raise ArgumentError("a frame's A is singular; give an invertible one")
    elif off > 1e-6:
        raise ArgumentError(
            "A is no rotation: a frame that scales or shears has no orientation; give a "
            "rigid motion"
        )
    return off


def check_columns(work: Charts, frame: Frame) -> Frame:
    """A frame of the columns, or an ArgumentError where it leads off the manifold."""
    A, b = frame.A, frame.b
    if A.shape[-2] != work.width:
        raise ArgumentError(f"A has shape {A.shape}; {work} has {work.width} columns")
    inside = np.zeros((work.width, work.width), bool)
    for space, columns, _ in work.blocks:
        inside[columns, columns] = True
        if space.wrong(A[..., columns, columns], b[..., columns]):
            raise ArgumentError(
                f"a frame's A and b in columns {columns.start} to {columns.stop - 1} lead off "
                f"{space}; give an invertible A for R, a rotation for S2, a left "
                "multiplication by a unit quaternion for S3 (Manifold.frame makes one)"
            )
    if np.abs(A[..., ~inside]).max(initial=0.0) > 1e-9:
        raise ArgumentError(f"a frame's A mixes factors of {work}; give one block for each")
    return frame
