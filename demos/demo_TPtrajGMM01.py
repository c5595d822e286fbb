"""demo_TPtrajGMM01: a TP-GMM over position, velocity and acceleration (Section 5.2, Fig. 12).

Look for: no time in the model, yet a smooth movement: a sequence of states says where, how fast
and with what acceleration, and the most likely trajectory agrees with all three (Eq. 30).
"""

from tpsim import fit_tp_gmm, trajectory_of_states
from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations


def retrieve():
    """Learn [x, dx, ddx] in two frames; states follow each other as in the demonstrations."""
    demonstrations, tasks = u_demonstrations(5), situations()
    moving = [d.with_derivatives(2) for d in demonstrations]
    model = fit_tp_gmm(moving, 3, start="time")
    states = model.responsibilities(moving).reshape(5, 200, 3).mean(0).argmax(1)
    dt = demonstrations[0].time[1]
    gmms = [model.adapt([frame.with_derivatives(2) for frame in frames]) for frames in tasks]
    paths = [trajectory_of_states(gmm, states, dt) for gmm in gmms]
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
