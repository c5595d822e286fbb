"""Four situations of the planar transfer, ever farther along one way (Figs 12 to 14)."""

import numpy as np

from tpsim.examples import u_demonstration, u_frames
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.section8 import measures
from tpsim.section8.method import Path
from tpsim.section8.plan import Plan


def situations(seed: int = 2016) -> list[tuple[Frame, Frame]]:
    """Frames at every distance of the comparison; the demonstrations have a spread of 1."""
    stream = np.random.SeedSequence(seed, spawn_key=(0,))
    return [u_frames(np.random.default_rng(stream), spread) for spread in Plan().distances]


def measure(path: Path, frames: tuple[Frame, Frame]) -> dict[str, float]:
    """Figures of a retrieved movement between two frames (:func:`tpsim.section8.measure`)."""
    x = path.mean if isinstance(path, Gaussian) else path
    return measures.measure(path, u_demonstration(frames, len(x)))
