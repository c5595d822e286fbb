"""demo_affineTransform01: one movement seen from two frames, as [x], [t, x] and [x, dx].

Look for: in its own frame every demonstration starts (or ends) at the same place; going back to
common coordinates loses nothing (Eqs 4, 20 and 32).
"""

from functools import cache

import numpy as np

from tpsim import Frame, plot
from tpsim.examples import u_demonstrations
from tpsim.gallery import present, within


@cache
def observe():
    """Positions, positions with time, positions with velocity."""
    plain = u_demonstrations(5)
    return {
        "x": plain,
        "t_x": [d.with_time() for d in plain],
        "x_dx": [d.with_derivatives(1) for d in plain],
    }


def main():
    seen, figures = observe(), {}
    for name, demonstrations in seen.items():
        errors = [
            np.abs(frame.to_common(view) - d.data).max()
            for d in demonstrations
            for frame, view in zip(d.frames, d.observations, strict=True)
        ]
        figures[f"error_there_and_back_{name}"] = within(
            max(errors), 0, 1e-12, "A is invertible: there and back to rounding"
        )
    starts = np.array([[d.data[0], *(view[0] for view in d.observations)] for d in seen["x"]])
    common, first, second = starts.std(0).max(1)
    return figures | {
        "spread_of_starts_common_m": within(common, 0.05, 0.3, "objects are moved by up to 0.3"),
        "spread_of_starts_first_m": within(first, 0, 1e-12, "the movement starts at the object"),
        "spread_of_starts_second_m": within(second, 0.05, 0.6, "it depends on both objects"),
    }


def draw(figure):
    axes, demonstrations = plot.panels(figure, 1, 3), observe()["x"]
    plot.demonstrations(axes[0], demonstrations, label="demonstrations")
    axes[0].set_ylabel("y [m]")
    for d in demonstrations:
        plot.frames(axes[0], d.frames, size=0.6, labels=("first object", "second object"))
    for j, axis in enumerate(axes[1:]):
        plot.demonstrations(axis, [d.observations[j] for d in demonstrations])
        plot.frames(axis, [Frame(np.eye(2), np.zeros(2))], plot.PALETTE[2 + j :])
    for axis, name in zip(axes, ("common coordinates", "first frame", "second frame"), strict=True):
        axis.set_xlabel("x [m]")
        plot.title(axis, name)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
