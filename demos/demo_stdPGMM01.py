"""demo_stdPGMM01: a parametric Gaussian mixture, whose centres follow the task (Section 8.2).

Look for: near the demonstrations the movement ends at the second object; far from them it misses
by more and more, because only the centres adapt, by a map that was fitted to what was shown.
"""

import numpy as np

from tpsim import fit_pgmm, gmr, task_vector
from tpsim.examples import u_demonstrations, u_frames


def learn():
    """Learn [t, x] with centres affine in the frames' origins and axes (Eq. 48)."""
    demonstrations = u_demonstrations(12)
    timed = [d.with_time().data for d in demonstrations]
    tasks = [task_vector(d.frames) for d in demonstrations]
    return demonstrations, timed[0][:, :1], fit_pgmm(timed, tasks, 5, start="time")


def miss(model, time, frames) -> float:
    """Distance between the end of the movement and the second object."""
    path = gmr(model.adapt(task_vector(frames)), time)
    return float(np.linalg.norm(path.mean[-1] - frames[1].b))


def main() -> dict:
    demonstrations, time, model = learn()
    figures = {"log_likelihood_of_a_sample": float(model.history[-1])}
    figures["miss_shown"] = max(miss(model, time, d.frames) for d in demonstrations)
    for spread in (1.0, 2.0, 4.0):
        rng = np.random.default_rng(5)
        misses = [miss(model, time, u_frames(rng, spread)) for _ in range(20)]
        figures[f"median_miss_new_spread_{spread:.0f}"] = float(np.median(misses))
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_frames, draw_path

    demonstrations, time, model = learn()
    _, axes = plt.subplots(1, 3)
    for axis, spread in zip(axes, (1.0, 2.0, 4.0), strict=True):
        frames = u_frames(np.random.default_rng(5), spread)
        draw_demonstrations(axis, demonstrations)
        draw_path(axis, gmr(model.adapt(task_vector(frames)), time))
        draw_frames(axis, frames)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
