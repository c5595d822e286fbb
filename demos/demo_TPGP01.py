"""demo_TPGP01: a Gaussian process in every frame, fused over frames (Section 8, Fig. 13).

Look for: data-driven retrieval adapts to the frames like a mixture does, with the spread of the
data around each process as its certainty; it keeps all its data, and is slower for it.
"""

import numpy as np

from tpsim import SquaredExponential, fit_gp, fuse_frames
from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations


def retrieve():
    """Regress over time in each frame, then take the product at every step."""
    demonstrations, tasks = u_demonstrations(5, samples=100), situations()
    times = demonstrations[0].time
    time = np.concatenate([d.time for d in demonstrations])
    views = zip(*(d.observations for d in demonstrations), strict=True)
    kernel = SquaredExponential(variance=1.0, length=0.2, noise=1e-2)
    local = [fit_gp(time, np.concatenate(view), kernel).spread(times) for view in views]
    return demonstrations, tasks, [fuse_frames(local, frames) for frames in tasks]


def main() -> dict:
    _, tasks, paths = retrieve()
    figures = [measure(path, task) for path, task in zip(paths, tasks, strict=True)]
    return {
        "end_errors": [f["end"] for f in figures],
        "entry_angles": [f["direction"] for f in figures],
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_frames, draw_path

    demonstrations, tasks, paths = retrieve()
    axes = plt.figure(figsize=(12, 4)).subplots(1, len(tasks), sharex=True, sharey=True)
    for axis, path, frames in zip(axes, paths, tasks, strict=True):
        draw_demonstrations(axis, demonstrations)
        draw_path(axis, path)
        draw_frames(axis, frames)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
