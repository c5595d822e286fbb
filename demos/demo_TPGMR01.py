"""demo_TPGMR01: a TP-GMM over time, adapted to new frames and retrieved by GMR (Section 5.1).

Look for: the movement leaves the first object and enters the second along their open sides,
wherever they are. The product over frames comes first, then the regression (Eqs 5-6, 17-20).
"""

from tpsim import fit_tp_gmm, gmr
from tpsim.examples import u_demonstrations
from tpsim.section8.planar import measure, situations


def retrieve():
    """Learn [t, x] in two frames; time is an input that no frame changes (Eq. 20)."""
    demonstrations, tasks = u_demonstrations(5), situations()
    timed = [d.with_time() for d in demonstrations]
    model = fit_tp_gmm(timed, 6, start="time")
    times = timed[0].data[:, :1]
    gmms = [model.adapt([frame.with_input() for frame in frames]) for frames in tasks]
    return demonstrations, tasks, [gmr(gmm, times) for gmm in gmms]


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
