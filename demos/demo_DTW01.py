"""demo_DTW01: demonstrations with different timing, realigned by dynamic time warping.

Look for: the same strokes lie on top of each other over time; the paths in the plane stay.
"""

from functools import cache

import numpy as np

from tpsim import align, plot
from tpsim.examples import letters
from tpsim.gallery import present, within


@cache
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


def spread(demonstrations):
    """Root mean square deviation from the mean movement [m]."""
    return float(np.sqrt(np.var([d.data for d in demonstrations], axis=0).sum(1).mean()))


def main():
    written, aligned = realign()
    own = spread(letters("G", count=5))
    return {
        "spread_as_written_m": within(spread(written), 0.3, 1.0, "a stroke's width: out of step"),
        "spread_aligned_m": within(
            spread(aligned), 0, own, f"at most the spread before the timing was changed: {own:.3f}"
        ),
    }


def draw(figure):
    axes = plot.panels(figure, 2, 2, size=(3.4, 2.2), kind=["plane", "curve"])
    for row, name in enumerate(("as written", "aligned")):
        plane, curve = axes[2 * row : 2 * row + 2]
        demonstrations = realign()[row]
        plot.demonstrations(plane, demonstrations)
        for d, colour in zip(demonstrations, plot.PALETTE, strict=False):
            curve.plot(d.time, d.data[:, 0], color=colour, lw=1.4)
        plane.set(ylabel=f"{name}\ny [m]")
        curve.set(ylabel="x [m]")
    plane.set(xlabel="x [m]")
    curve.set(xlabel="time [s]")


if __name__ == "__main__":
    present(__file__, main, draw)
