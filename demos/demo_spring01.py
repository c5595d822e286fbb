"""demo_spring01: influence of the damping ratio in mass-spring-damper systems.

Look for: below the ratio 1 the mass overshoots its target, above it creeps. The optimal
controller of Section 6 has the ratio 1 / sqrt(2), which overshoots by 4 %.
"""

from functools import cache

import numpy as np

from tpsim import damping_of, plot, spring_damper
from tpsim.gallery import present, within

RATIOS = (0.2, 1 / np.sqrt(2), 1.0, 2.0)
STIFFNESS, DT = 50.0, 0.01


@cache
def solve():
    """Paths (T,) to a target at 1, one for each damping ratio."""
    return {
        ratio: spring_damper(
            np.ones((200, 1)), STIFFNESS, damping_of(STIFFNESS, ratio), DT, [0.0, 0.0]
        ).states[:, 0]
        for ratio in RATIOS
    }


def main():
    figures = {}
    for ratio, x in solve().items():
        damped = ratio < 1
        exact = np.exp(-np.pi * ratio / np.sqrt(1 - ratio**2)) if damped else 0.0
        figures[f"overshoot_{ratio:.2f}"] = within(
            max(0.0, x.max() - 1), exact - 0.03, exact + 0.03, f"continuous time: {exact:.3f}"
        )
    return figures


def draw(figure):
    (axis,) = plot.panels(figure, kind="curve", size=(5.0, 3.0))
    for (ratio, x), colour in zip(solve().items(), plot.PALETTE, strict=False):
        axis.plot(DT * np.arange(len(x)), x, color=colour, lw=1.8, label=f"ratio {ratio:.2f}")
    axis.axhline(1, color=plot.INK, lw=1, ls="--", label="target")
    axis.set(xlabel="time [s]", ylabel="position [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
