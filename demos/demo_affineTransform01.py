"""demo_affineTransform01: one movement seen from two frames, as [x], [t, x] and [x, dx].

Look for: in its own frame every demonstration starts (or ends) at the same place; going back to
common coordinates loses nothing (Eqs 4, 20 and 32).
"""

import numpy as np

from tpsim.examples import u_demonstrations


def observe():
    """Positions, positions with time, positions with velocity."""
    plain = u_demonstrations(5)
    return {
        "x": plain,
        "t_x": [d.with_time() for d in plain],
        "x_dx": [d.with_derivatives(1) for d in plain],
    }


def main() -> dict:
    seen = observe()
    figures = {}
    for name, demonstrations in seen.items():
        errors = [
            np.abs(frame.to_common(view) - d.data).max()
            for d in demonstrations
            for frame, view in zip(d.frames, d.observations, strict=True)
        ]
        figures[f"error_there_and_back_{name}"] = float(max(errors))
    starts = np.array([[d.data[0], *(view[0] for view in d.observations)] for d in seen["x"]])
    for name, spread in zip(("common", "frame_1", "frame_2"), starts.std(0).max(1), strict=True):
        figures[f"spread_of_the_starts_in_{name}"] = float(spread)
    return figures


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_frames

    _, axes = plt.subplots(1, 3)
    demonstrations = observe()["x"]
    draw_demonstrations(axes[0], demonstrations)
    for d in demonstrations:
        draw_frames(axes[0], d.frames)
        for axis, view in zip(axes[1:], d.observations, strict=True):
            axis.plot(*view.T, lw=0.8)
    for axis, title in zip(axes, ("common", "frame 1", "frame 2"), strict=True):
        axis.set_title(title)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
