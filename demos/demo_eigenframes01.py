"""demo_eigenframes01: eigenframes, eigentrajectories and redundant frames (Section 9).

Look for: three eigenframes for four frames, since a sticker on the second object sees what the
object sees; both would count as relevant, and the product would believe itself too much.
"""

from functools import cache

import numpy as np

import tpsim as tp
from tpsim import plot
from tpsim.examples import u_demonstrations, u_frames
from tpsim.gallery import present, within

NAMES = ("first object", "second object", "sticker on it", "passer-by")
TITLES = ("seen from four frames", "eigentrajectories", "unexplained (white: 0)", "new situation")


def turned(angle: float) -> np.ndarray:
    """Rotation in the plane."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def with_more(frames: tuple[tp.Frame, ...], rng: np.random.Generator) -> list[tp.Frame]:
    """The two objects, a sticker on the second one, and something that passes by."""
    sticker = tp.Frame(frames[1].A @ turned(2.0), frames[1].b + frames[1].A @ [0.3, 0.1])
    return [*frames, sticker, tp.Frame(turned(rng.uniform(-3, 3)), rng.normal([0, 1], 0.5))]


@cache
def learn():
    """Demonstrations; how frames vary together; what is redundant; products with and without it."""
    rng, seen = np.random.default_rng(9), u_demonstrations(10)
    taught = [tp.Demonstration(d.time, d.data, with_more(d.frames, rng)) for d in seen]
    new = with_more(u_frames(np.random.default_rng(3), spread=1.5), rng)
    same = tp.redundant_frames(taught)
    relevant = tp.frame_report(tp.fit_tp_gmm(taught, 4, start="time"), taught)
    matter = [j for j in range(4) if j not in relevant.never]
    model = tp.fit_tp_gmm([d.seen_from(matter) for d in taught], 4, start="time")
    there = [[new[j] if j in known else None for j in matter] for known in (matter, same.kept)]
    products = [model.adapt(frames).gaussians for frames in there]
    return taught, new, tp.eigenframes(taught, share=0.98), same, relevant, products


def main() -> dict:
    """How many eigenframes there are, what is redundant, and what it costs to count it twice."""
    _, _, varied, same, relevant, (twice, once) = learn()
    values, tucker = varied.decomposition.values[1], "98 % of the variance is smooth and shared"
    narrow = np.linalg.det(once.covariance[-1]) / np.linalg.det(twice.covariance[-1])
    return {
        "fourth_eigenframe": within(values[3] / values[0], 0, 1e-3, "three span what four see"),
        "sticker_sees_what_frame": within(same.instead.get(2, -1), 1, 1, "it is fixed to it"),
        "irrelevant_frames": within(len(relevant.never), 1, 1, "the passer-by; the sticker is not"),
        "believed_too_much": within(narrow, 3.6, 4.4, "2^2: twice the precision in the plane"),
        "eigentrajectories": within(varied.trajectories.shape[1], 2, 6, tucker),
        "compression": within(varied.compression, 5, np.inf, tucker),
    }


def draw(figure) -> None:
    """Draw demonstrations, eigentrajectories, who sees what whom sees, and both products."""
    taught, new, varied, same, _, products = learn()
    common, courses, table, there = axes = plot.panels(figure, 1, 4, size=(2.7, 2.5))
    plot.demonstrations(common, taught, label="demonstrations")
    plot.frames(common, taught[0].frames, size=0.6, labels=NAMES)
    for course, colour in zip(varied.trajectories.T, plot.PALETTE, strict=False):
        courses.plot(np.linspace(0, 1, len(course)), course, color=colour)
    plot.matrix(table, -np.clip(same.unexplained, 0, 1))
    for gaussians, k, sticker in zip(products, (0, 1), ("with the", "without"), strict=True):
        plot.ellipses(there, gaussians, plot.PALETTE[k], label=f"components {sticker} sticker")
    plot.frames(there, new, size=0.6)
    for axis, text in zip(axes, TITLES, strict=True):
        plot.title(axis, text)
    courses.set_xlabel("progress")
    table.set(xlabel="by frame", ylabel="seen by frame")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
