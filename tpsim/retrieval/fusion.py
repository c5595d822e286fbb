"""The product over frames of what a regression retrieved in each of them."""

from collections.abc import Sequence

from tpsim.checks import several
from tpsim.errors import ArgumentError
from tpsim.frame import Frame, frames_or_none
from tpsim.gaussian import Gaussian
from tpsim.retrieval.distribution import TPTrajectoryDistribution, TrajectoryDistribution


def fuse_frames(views: Sequence[Gaussian], frames: Sequence[Frame | None]) -> Gaussian:
    """Product over frames at every time step, Eqs 5-6: data-driven models (TP-GP, TP-LWR).

    Parameters
    ----------
    views
        P Gaussians (T, d_j), what a regression retrieved in each frame.
    frames
        P frames, constant or moving with leading axis T; None where one is not observed.

    Returns
    -------
    Gaussian with mean (T, D) and covariance (T, D, D).

    Raises
    ------
    ArgumentError
        Another number of frames than of views, all of them None, or shapes that do not fit.
    """
    views, known = several("views", views, Gaussian), frames_or_none("frames", frames)
    seen = [(view, frame) for view, frame in zip(views, known, strict=False) if frame is not None]
    if len(views) != len(known) or not seen:
        raise ArgumentError(
            f"{len(views)} views and {len(known)} frames were given, {len(seen)} of them observed; "
            "give as many of both, and at least one that is not None"
        )
    model = TPTrajectoryDistribution(
        tuple(TrajectoryDistribution.of(view, f"views[{j}]") for j, (view, _) in enumerate(seen))
    )
    return model.adapt([frame for _, frame in seen]).marginal()
