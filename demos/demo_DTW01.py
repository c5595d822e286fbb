"""demo_DTW01: demonstrations with different timing, realigned by dynamic time warping.

Look for: the same strokes lie on top of each other over time; the paths in the plane stay.
"""

import numpy as np

from tpsim import align
from tpsim.examples import letters


def realign():
    """Letters written with the pen faster at the start, or at the end, and aligned again."""
    rng = np.random.default_rng(3)
    written = []
    for d in letters("G", count=5):
        duration = d.time[-1]
        bent = duration * (d.time / duration) ** rng.uniform(0.6, 1.6)
        data = np.column_stack([np.interp(bent, d.time, column) for column in d.data.T])
        written.append(type(d)(d.time, data, name=d.name))
    return written, align(written, band=100)


def spread(demonstrations) -> float:
    """Root mean square deviation from the mean movement."""
    return float(np.sqrt(np.var([d.data for d in demonstrations], axis=0).sum(1).mean()))


def main() -> dict:
    written, aligned = realign()
    return {
        "spread_as_written": spread(written),
        "spread_aligned": spread(aligned),
        "spread_of_the_letters_themselves": spread(letters("G", count=5)),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations

    _, axes = plt.subplots(2, 2)
    for row, demonstrations in zip(axes, realign(), strict=True):
        draw_demonstrations(row[0], demonstrations)
        for d in demonstrations:
            row[1].plot(d.time, d.data[:, 0])
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
