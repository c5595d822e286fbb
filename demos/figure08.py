"""figure08: movements with two options, learned from partial demonstrations (Section 5.2, Fig. 8).

Look for: no demonstration shows the whole movement; pieces overlap, and the states that they share
join them. Every movement that is drawn takes one of the two ways, both alike often, and is smooth.
"""

from functools import cache

import numpy as np
from _options import DT, chain_of, pieces, sample, whole

from tpsim import fit_gmm, plot, trajectory_of_states
from tpsim.gallery import present, within

STATES, DRAWS = 18, 40


@cache
def write():
    """Mixture of [x, dx], and movements (T,) along states that were drawn at random."""
    rng = np.random.default_rng(1)
    gmm = fit_gmm(pieces(), STATES, start="kmeans", ridge=1e-2, rng=rng)
    chain = chain_of(gmm, pieces())
    drawn = [sample(chain, rng) for _ in range(DRAWS)]
    return gmm, [trajectory_of_states(gmm, q, DT, derivatives=1) for q in drawn]


def option(path):
    return "upper" if path.mean[len(path.mean) // 2, 1] > 0 else "lower"


def main():
    _, paths = write()
    share = np.mean([option(path) == "upper" for path in paths])
    away = [np.linalg.norm(p.mean[:, None] - whole(option(p)), axis=2).min(1).max() for p in paths]
    ends = [np.linalg.norm(path.mean[-1] - whole("upper")[-1]) for path in paths]
    step = max(np.linalg.norm(np.diff(p.mean, axis=0), axis=1).max() for p in paths)
    taught = np.linalg.norm(np.diff(whole("upper"), axis=0), axis=1).max()
    return {
        "share_of_the_upper_way": within(
            share, 0.26, 0.74, "equal chances: 0.5 within three standard deviations of 40 draws"
        ),
        "farthest_from_its_way_m": within(max(away), 0, 0.25, "18 states, 0.4 m apart"),
        "farthest_end_m": within(max(ends), 0, 0.35, "it ends in its last state, 0.4 m long"),
        "largest_step_over_taught": within(
            step / taught, 0.7, 1.5, "smooth: no jump where pieces or states meet"
        ),
    }


def draw(figure):
    gmm, paths = write()
    axes = plot.panels(figure, 1, 3, size=(3.2, 1.9))
    left, centre, right = axes
    for piece, shade in zip(pieces(), plot.shades(plot.INK, 4, 0.7), strict=True):
        left.plot(*piece[:, :2].T, color=shade, lw=3, label="demonstrations, light to dark")
    plot.demonstrations(centre, pieces())
    plot.ellipses(centre, gmm.gaussians.marginal([0, 1]), label="states")
    for way, colour in zip(("upper", "lower"), plot.PALETTE[1:], strict=False):
        path = next(path for path in paths if option(path) == way)
        plot.tube(right, path, colour, label=f"{way} way, with its spread")
    for axis, title in zip(axes, ("partial demonstrations", "model", "two draws"), strict=True):
        plot.title(axis, title)
        axis.set_xlabel("x [m]")
    left.set_ylabel("y [m]")
    plot.same_view(axes)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
