"""figure03: what two frames expect, and the compromise between them (Section 2.2, Fig. 3).

Look for: the least of a weighted sum of squared errors (contours, Eq. 3) lies at the centre of the
product of the two Gaussians, near the frame that is sure, in the direction in which it is sure.
"""

from functools import cache

import numpy as np
from scipy.optimize import minimize

from tpsim import Gaussian, fit_tp_gmm, gaussian_product, plot
from tpsim.examples import u_demonstrations, u_frames
from tpsim.gallery import present, within


@cache
def expect():
    """Frames of a new situation, what each expects of the middle component, the product."""
    model = fit_tp_gmm(u_demonstrations(8), 3, start="time")
    frames = u_frames(np.random.default_rng(3), spread=1.2)
    expected = [
        Gaussian(seen.mean[1], seen.covariance[1]).affine(frame.A, frame.b)
        for frame, seen in zip(frames, model.frames, strict=True)
    ]
    return frames, expected, gaussian_product(expected)


def cost(x):
    """Weighted sum of quadratic error terms, Eq. (3), for points (..., 2)."""
    gaps = [(x - g.mean, g.precision) for g in expect()[1]]
    return sum(np.einsum("...i,ij,...j->...", gap, precision, gap) for gap, precision in gaps)


def main():
    _, expected, product = expect()
    least = minimize(cost, expected[0].mean, tol=1e-12).x
    curvature = sum(g.precision for g in expected) @ product.covariance
    between = min(cost(g.mean) for g in expected) / cost(product.mean)
    return {
        "least_cost_to_product_m": within(
            np.linalg.norm(least - product.mean), 0, 1e-5, "they are the same point, Eq. (6)"
        ),
        "precisions_add_up": within(
            np.abs(curvature - np.eye(2)).max(), 0, 1e-9, "the product's covariance, Eq. (6)"
        ),
        "cost_at_a_centre_over_least": within(between, 1, 1e6, "neither frame is right alone"),
    }


def draw(figure):
    frames, expected, product = expect()
    (axis,) = plot.panels(figure, size=(5.4, 4.2))
    names = ("first frame expects", "second frame expects")
    for gaussian, colour, name in zip(expected, plot.PALETTE[2:], names, strict=False):
        plot.ellipses(axis, gaussian, colour, label=name)
    plot.ellipses(axis, product, plot.PALETTE[1], label="product")
    plot.frames(axis, frames)
    plot.same_view([axis])
    x, y = np.meshgrid(np.linspace(*axis.get_xlim(), 120), np.linspace(*axis.get_ylim(), 120))
    values = cost(np.stack([x, y], axis=-1)) - cost(product.mean)
    axis.contour(
        x, y, values, [0.25, 1, 4, 9, 16, 25, 36], colors=plot.INK, linewidths=0.6, alpha=0.5
    )
    axis.set(xlabel="x [m]", ylabel="y [m]")
    plot.legend(figure, columns=3)


if __name__ == "__main__":
    present(__file__, main, draw)
