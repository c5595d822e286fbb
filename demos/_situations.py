"""What the rows share that adapt a movement to its situation: what is taught, measures, picture.

Two U-shaped objects are the frames; the movement leaves the first and enters the second. The four
situations are ever farther from the taught ones, like the columns of Figs 12 to 14.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim import Demonstration, Gaussian, plot
from tpsim.examples import u_demonstrations
from tpsim.experiment.compare import measure, situations
from tpsim.experiment.methods import METHODS
from tpsim.gallery import Bounded, Draw, Main, within

TAUGHT = u_demonstrations(8)
SITUATIONS = situations()
PLACES = ("nearer than taught", "as far as taught", "twice as far", "three times as far")
WIDTH = 0.4  # of an object [m]


def adapt(retrieve: Callable[..., Gaussian]) -> list[Gaussian]:
    """Retrieve the movement (T, 2) in every situation."""
    return [retrieve(frames) for frames in SITUATIONS]


def errors(paths: Sequence[Gaussian], name: str) -> np.ndarray:
    """One of the measures of Section 8 for every situation (4,)."""
    return np.array([measure(path, f)[name] for path, f in zip(paths, SITUATIONS, strict=True)])


def figures(
    paths: Sequence[Gaussian], *, end: float = 0.25 * WIDTH, angle: float = 35.0
) -> dict[str, Bounded]:
    """Errors over all situations, for methods that follow the frames."""
    inside = "the start, inside the first object: a quarter of its width"
    why = "the end is inside the second object" if end < WIDTH else "the method misses the object"
    return {
        "largest_start_error_m": within(max(errors(paths, "start_error")), 0, 0.25 * WIDTH, inside),
        "largest_end_error_m": within(max(errors(paths, "end_error")), 0, end, why),
        "largest_entry_angle_deg": within(
            max(errors(paths, "entry_angle")), 0, angle, "it enters through the open side of the U"
        ),
    }


def draw(figure, *rows: Sequence[Gaussian], names: Sequence[str] = (), tracks=()) -> None:
    """Draw a row of four situations for every method; ``tracks`` are paths (T, 2) in black."""
    axes = plot.panels(figure, len(rows), 4, size=(2.7, 2.2))
    for i, axis in enumerate(axes):
        row, n = divmod(i, 4)
        plot.demonstrations(axis, TAUGHT, label="taught")
        plot.tube(axis, rows[row][n], label="retrieved, with its spread")
        plot.frames(axis, SITUATIONS[n], size=0.8, labels=("first object", "second object"))
        if len(tracks):
            axis.plot(*tracks[n].T, color=plot.INK, lw=1.2, label="spring and damper", zorder=4)
        plot.title(axis, PLACES[n] if row == 0 else "")
        axis.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1])
        if n == 0:
            axis.set_ylabel(f"{names[row]}\ny [m]" if len(names) else "y [m]")
        if row == len(rows) - 1:
            axis.set_xlabel("x [m]")
    plot.same_view(axes)
    plot.legend(figure)


def row(retrieve: Callable[[], Sequence[Gaussian]]) -> tuple[Main, Draw]:
    """Functions ``main`` and ``draw`` of a row that shows one method."""
    return lambda: figures(retrieve()), lambda figure: draw(figure, retrieve())


def learn(method: str, demonstrations: Sequence[Demonstration] = TAUGHT) -> Callable[..., Gaussian]:
    """Learn with one of the methods of Section 8; return how to retrieve given frames."""
    return METHODS[method](demonstrations)
