"""Speeds of learning and retrieval of poses on their manifold, R(1) * R(3) * S3."""

from functools import partial

import numpy as np

from tpsim import rotation
from tpsim.bench.timing import median_time
from tpsim.frame import Frame
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.manifold.manifold import S3, R
from tpsim.retrieval.gmr import Regression

POSES = R(1, "inputs") * R(3) * S3
COMPONENTS, DEMONSTRATIONS, STEPS, FRAMES = 5, 10, 200, 3


def learning(quick: bool = False) -> dict[str, float]:
    """Median of a fit (N = 2000, P = 3, K = 5) with time, and of its adaptation to new frames."""
    repetitions = 3 if quick else 15
    rng = np.random.default_rng(0)
    views = movements(rng)
    whole = partial(fit_tp_gmm, views, COMPONENTS, manifold=POSES, start="time")
    model, frames = whole(), situation(rng)
    return {
        "pose_fit_ms": 1e3 * median_time(whole, repetitions),
        "pose_fit_iterations": len(model.history) - 1,
        "pose_adapt_us": 1e6 * median_time(lambda: model.adapt(frames), 100 * repetitions),
    }


def retrieval(repetitions: int) -> dict[str, float]:
    """Median of one point of GMR after the frames have moved: adaptation and regression."""
    rng = np.random.default_rng(0)
    model = fit_tp_gmm(movements(rng), COMPONENTS, manifold=POSES, start="time")
    now, frames = np.array([0.6]), situation(rng)

    def follow() -> object:
        return Regression.of(model.adapt(frames)).at(now)

    return {"pose_gmr_one_point_moved_frame_us": 1e6 * median_time(follow, repetitions)}


def situation(rng: np.random.Generator) -> list[Frame]:
    """Frames that are placed and turned: [m], [rad]."""
    turns = 0.15 * rng.standard_normal((FRAMES, 3))
    turns[1:] += np.array([[0.0, 0.0, 1.5], [0.7, 0.0, 0.0]])
    places = np.arange(FRAMES)[:, None] * np.array([0.3, 0.1, 0.0])
    places = places + 0.1 * rng.standard_normal((FRAMES, 3))
    return [Frame(R, p) for R, p in zip(rotation.exp(turns), places, strict=True)]


def movements(rng: np.random.Generator) -> list[np.ndarray]:
    """Ways from the first frame by way of the others, as each frame sees them: (N, 8) each."""
    time = np.linspace(0.0, 1.0, STEPS)
    views: list[list[np.ndarray]] = [[] for _ in range(FRAMES)]
    for _ in range(DEMONSTRATIONS):
        frames = situation(rng)
        shares = np.exp(-0.5 * ((time[:, None] - np.linspace(0, 1, FRAMES)) / 0.2) ** 2)
        shares /= shares.sum(1, keepdims=True)
        position = shares @ np.array([frame.b for frame in frames])
        turns = shares @ rotation.log(np.array([frame.A @ frames[0].A.T for frame in frames]))
        noise = 0.05 * rng.standard_normal((STEPS, 6))
        orientation = rotation.exp(noise[:, 3:]) @ rotation.exp(turns) @ frames[0].A
        common = np.hstack([time[:, None], position + noise[:, :3]])
        common = np.hstack([common, rotation.to_quaternion(orientation)])
        for view, frame in zip(views, frames, strict=True):
            view.append(POSES.frame(frame).to_local(common))
    return [np.concatenate(view) for view in views]
