"""What the rows share that adapt a movement to its situation: what is taught, measures, picture.

Two U-shaped objects are the frames; the movement leaves the first and enters the second. The four
situations are ever farther from the taught ones, like the columns of Figs 12 to 14.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim import Demonstration, Frame, Gaussian, plot
from tpsim.examples import u_demonstrations
from tpsim.gallery import Bounded, Draw, Main, within
from tpsim.section8 import METHODS
from tpsim.section8.planar import situations

TAUGHT = u_demonstrations(8)
SITUATIONS = situations()
PLACES = ("nearer than taught", "as far as taught", "twice as far", "four times as far")
WIDTH = 0.4  # of an object [m]


def adapt(retrieve: Callable[..., Gaussian]) -> list[Gaussian]:
    """Retrieve the movement (T, 2) in every situation."""
    return [retrieve(frames) for frames in SITUATIONS]


def errors(paths: Sequence[Gaussian], name: str) -> np.ndarray:
    """``"start"`` or ``"end"`` error [m], or ``"entry"`` angle [deg], in every situation (4,).

    The entry angle is that between the last 0.1 m of the path and the open side of the object.
    """
    pairs = zip(paths, SITUATIONS, strict=True)
    return np.array([_error(path.mean, *frames, name) for path, frames in pairs])


def _error(x: np.ndarray, first: Frame, second: Frame, name: str) -> float:
    if name != "entry":
        point, frame = (x[0], first) if name == "start" else (x[-1], second)
        return float(np.linalg.norm(point - frame.b))
    away = np.linalg.norm(x - x[-1], axis=1)
    piece = x[np.flatnonzero(away > 0.1)[-1]] - x[-1] if away.max() > 0.1 else x[0] - x[-1]
    axis = second.A[:, 1]
    cosine = piece @ axis / max(np.linalg.norm(piece) * np.linalg.norm(axis), 1e-12)
    return float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def figures(
    paths: Sequence[Gaussian], *, end: float = 0.25 * WIDTH, angle: float = 35.0
) -> dict[str, Bounded]:
    """Errors over all situations, for methods that follow the frames."""
    inside = "the start, inside the first object: a quarter of its width"
    why = "the end is inside the second object" if end < WIDTH else "the method misses the object"
    return {
        "largest_start_error_m": within(max(errors(paths, "start")), 0, 0.25 * WIDTH, inside),
        "largest_end_error_m": within(max(errors(paths, "end")), 0, end, why),
        "largest_entry_angle_deg": within(
            max(errors(paths, "entry")), 0, angle, "it enters through the open side of the U"
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


PRINTED = {"TP-GMM": "TP-GMR product"}
"""Rows whose method the tutorial has in the order of Eqs 5-6: the product first."""


def learn(method: str, demonstrations: Sequence[Demonstration] = TAUGHT) -> Callable[..., Gaussian]:
    """Learn with one of the methods of Section 8; return how to retrieve given frames."""
    retrieve = METHODS[PRINTED.get(method, method)](list(demonstrations))

    def gaussian(frames: Sequence[Frame]) -> Gaussian:
        path = retrieve(frames)
        if isinstance(path, Gaussian):
            return path
        return Gaussian(path, np.zeros((*path.shape, path.shape[1])))

    return gaussian
