"""demo_GMR01: Gaussian mixture regression of a letter over time (Section 5.1, Fig. 7).

Look for: a smooth path with a full covariance at every step, wide where the demonstrations vary.
"""

from functools import cache

import numpy as np

from tpsim import fit_gmm, gmr, plot
from tpsim.examples import letters
from tpsim.gallery import present, within


@cache
def retrieve():
    """Learn [t, x] as one mixture, then ask for x given t."""
    demonstrations = letters("G", count=5)
    timed = [d.with_time().data for d in demonstrations]
    gmm = fit_gmm(timed, 8, start="time")
    return demonstrations, gmm, gmr(gmm, timed[0][:, :1])


def main():
    demonstrations, _, path = retrieve()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    spread = np.sqrt(np.linalg.eigvalsh(path.covariance)[:, -1])
    return {
        "largest_distance_from_mean_m": within(
            np.abs(path.mean - mean).max(), 0, 0.2, "eight pieces, nearly straight, of a bent path"
        ),
        "widest_spread_m": within(spread.max(), 0.05, 0.4, "letters vary by 0.05 and more"),
        "narrowest_spread_m": within(spread.min(), 0.02, 0.1, "no narrower than the letters"),
    }


def draw(figure):
    demonstrations, gmm, path = retrieve()
    plane, *curves = plot.panels(figure, 1, 3, kind=["plane", "curve", "curve"])
    plot.demonstrations(plane, demonstrations, label="demonstrations")
    plot.tube(plane, path, label="retrieved, with its spread")
    plane.set(xlabel="x [m]", ylabel="y [m]")
    time = demonstrations[0].time
    for k, axis in enumerate(curves):
        plot.demonstrations(axis, [np.c_[d.time, d.data[:, k]] for d in demonstrations])
        plot.ellipses(axis, gmm.gaussians.marginal([0, 1 + k]), fill=0.15, label="components")
        plot.band(axis, time, path.mean[:, k], np.sqrt(path.covariance[:, k, k]))
        axis.set(xlabel="time [s]", ylabel=f"{'xy'[k]} [m]")
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
