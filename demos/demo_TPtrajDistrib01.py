"""demo_TPtrajDistrib01: whole trajectories as one Gaussian, by eigencomponents (Section 5.2).

Look for: three modes per frame hold what varies between demonstrations; their product over frames
stays low rank, so its cost grows with the length of the movement only.
"""

from tpsim import fit_tp_trajectory_distribution
from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations


def retrieve():
    """Keep 3 eigencomponents of the trajectories in each frame, then multiply."""
    demonstrations, tasks = u_demonstrations(5), situations()
    model = fit_tp_trajectory_distribution(demonstrations, 3, noise=1e-2)
    paths = [model.adapt(frames).marginal() for frames in tasks]
    return demonstrations, tasks, paths


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
