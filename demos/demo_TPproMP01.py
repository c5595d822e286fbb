"""demo_TPproMP01: probabilistic movement primitives seen from several frames (Section 5.2).

Look for: a few basis functions carry the whole movement; the product over frames is taken once,
on their weights, and gives correlations between all time steps.
"""

from tpsim import fit_tp_promp
from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations


def retrieve():
    """Fit the weights of 12 basis functions in each frame, then multiply the Gaussians."""
    demonstrations, tasks = u_demonstrations(5), situations()
    model = fit_tp_promp(demonstrations, 12, weight_ridge=1e-3)
    paths = [model.adapt(frames).distribution(200).marginal() for frames in tasks]
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
