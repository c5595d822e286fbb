"""demo_GPR01: Gaussian processes from task parameters to trajectories and mixtures (Section 8.1).

Look for: both follow the frames near the demonstrations; far away they collapse to an average
movement, because nothing in them knows what a frame is.
"""

from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations
from tpsim.section8.without_frames import gpr, gpr_gmm


def retrieve():
    """Learn both from the same demonstrations; situations go from near to far."""
    demonstrations, tasks = u_demonstrations(5), situations()
    paths = {
        name: [learned(task) for task in tasks]
        for name, learned in (("raw", gpr(demonstrations)), ("mixture", gpr_gmm(demonstrations)))
    }
    return demonstrations, tasks, paths


def main() -> dict:
    _, tasks, paths = retrieve()
    return {
        f"{name}_end_error_{where}": measure(paths[name][n], tasks[n])["end"]
        for name in paths
        for where, n in (("near", 0), ("far", -1))
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_frames, draw_path

    demonstrations, tasks, paths = retrieve()
    grid = plt.figure(figsize=(12, 6)).subplots(len(paths), len(tasks), sharex=True, sharey=True)
    for axes, name in zip(grid, paths, strict=True):
        axes[0].set_ylabel(name)
        for axis, path, frames in zip(axes, paths[name], tasks, strict=True):
            draw_demonstrations(axis, demonstrations)
            draw_path(axis, path)
            draw_frames(axis, frames)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
