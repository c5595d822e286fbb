"""figure04: a TP-GMM adapted to a new situation, component by component (Section 3, Fig. 4).

Look for: (a-b) the model as each frame knows it, (c) the mixture for new frames, and (d-f) how each
of its Gaussians is the product of what the two frames expect: the first follows the first object,
the last the second one.
"""

from functools import cache

import numpy as np

from tpsim import Frame, Gaussian, fit_tp_gmm, gaussian_product, plot
from tpsim.examples import u_demonstrations, u_frames
from tpsim.gallery import present, within

TITLES = ("(a) in the first frame", "(b) in the second frame", "(c) new situation")
DETAILS = ("(d) first component", "(e) second component", "(f) third component")


@cache
def adapt():
    """Demonstrations, model, new frames, adapted mixture, and what each frame expects."""
    taught = u_demonstrations(8)
    model = fit_tp_gmm(taught, 3, start="time")
    frames = u_frames(np.random.default_rng(3), spread=1.2)
    expected = [seen.affine(f.A, f.b) for seen, f in zip(model.frames, frames, strict=True)]
    return taught, model, frames, model.adapt(frames).gaussians, expected


def component(gaussians, k):
    return Gaussian(gaussians.mean[k], gaussians.covariance[k])


def main():
    _, _, frames, adapted, expected = adapt()
    by_hand = [gaussian_product([component(g, k) for g in expected]) for k in range(3)]
    gaps = [np.abs(by_hand[k].mean - adapted.mean[k]).max() for k in range(3)]
    widths = np.sqrt([[np.linalg.det(g.covariance[k]) for g in expected] for k in (0, 2)])
    return {
        "product_by_hand_m": within(max(gaps), 0, 1e-9, "Eqs 5-6, in one call and step by step"),
        "first_surer_at_start": within(widths[0, 1] / widths[0, 0], 5, np.inf, "area of ellipses"),
        "second_surer_at_end": within(widths[1, 0] / widths[1, 1], 5, np.inf, "area of ellipses"),
        "last_to_second_object_m": within(
            np.linalg.norm(adapted.mean[2] - frames[1].b), 0, 0.3, "inside the walls of the U"
        ),
    }


def draw(figure):
    taught, model, frames, adapted, expected = adapt()
    axes = plot.panels(figure, 2, 3, size=(3.0, 2.4))
    for j, axis in enumerate(axes[:2]):
        plot.demonstrations(axis, [d.observations[j] for d in taught], label="demonstrations")
        plot.ellipses(axis, model.frames[j], plot.PALETTE[2 + j], label=f"frame {j + 1}")
        plot.frames(axis, [Frame(np.eye(2), np.zeros(2))], plot.PALETTE[2 + j :])
    for k, axis in enumerate(axes[2:], start=-1):
        plot.frames(axis, frames)
        for j in range(2 if k >= 0 else 0):
            plot.ellipses(axis, component(expected[j], k), plot.PALETTE[2 + j])
        shown = adapted if k < 0 else component(adapted, k)
        plot.ellipses(axis, shown, plot.PALETTE[1], label="product")
    for axis, title in zip(axes, TITLES + DETAILS, strict=True):
        plot.title(axis, title)
    plot.same_view(axes[2:])
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
