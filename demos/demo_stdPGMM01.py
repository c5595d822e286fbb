"""demo_stdPGMM01: a parametric Gaussian mixture, whose centres follow the task (Section 8.2).

Look for: near the demonstrations the movement ends at the second object; far from them it misses
more and more, because only the centres adapt, by a map that was fitted to what was shown (Eq. 48).
"""

from functools import cache

import _situations as shared
import numpy as np

from tpsim import fit_pgmm, gmr, task_vector
from tpsim.examples import u_demonstrations, u_frames
from tpsim.gallery import present, within


@cache
def learn():
    """Learn [t, x] with centres affine in the frames' origins and axes; return how to retrieve."""
    taught = u_demonstrations(12)
    timed = [d.with_time().data for d in taught]
    model = fit_pgmm(timed, [task_vector(d.frames) for d in taught], 5, start="time")
    return taught, lambda frames: gmr(model.adapt(task_vector(frames)), timed[0][:, :1])


def misses(situations):
    """Distances between the ends of the movements and the second object [m]."""
    _, retrieve = learn()
    return [np.linalg.norm(retrieve(f).mean[-1] - f[1].b) for f in situations]


def drawn(spread):
    rng = np.random.default_rng(5)
    return [u_frames(rng, spread) for _ in range(20)]


def main():
    taught, _ = learn()
    shown = max(misses([d.frames for d in taught]))
    near, far = (np.median(misses(drawn(spread))) for spread in (1.0, 4.0))
    return {
        "largest_miss_shown_m": within(shown, 0, 0.05, "the map was fitted to these situations"),
        "median_miss_as_far_m": within(near, 0, 0.05, "12 situations determine the map"),
        "median_miss_far_over_near": within(
            far / near, 3, 30, "an affine map extrapolates outside the taught range"
        ),
    }


def draw(figure):
    _, retrieve = learn()
    shared.draw(figure, shared.adapt(retrieve))


if __name__ == "__main__":
    present(__file__, main, draw)
