"""demo_GMR01: Gaussian mixture regression of a letter over time (Section 5.1, Fig. 7).

Look for: a smooth path with a full covariance at every step, wide where the demonstrations vary.
"""

import numpy as np

from tpsim import fit_gmm, gmr
from tpsim.examples import letters


def retrieve():
    """Learn [t, x] as one mixture, then ask for x given t."""
    demonstrations = letters("G", count=5)
    timed = [d.with_time().data for d in demonstrations]
    gmm = fit_gmm(timed, 6, start="time")
    path = gmr(gmm, timed[0][:, :1])
    return demonstrations, gmm, path


def main() -> dict:
    demonstrations, gmm, path = retrieve()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    spread = np.sqrt(np.linalg.eigvalsh(path.covariance)[:, -1])
    return {
        "components": gmm.components,
        "distance_from_the_mean_demonstration": float(np.abs(path.mean - mean).max()),
        "widest_spread": float(spread.max()),
        "narrowest_spread": float(spread.min()),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_path

    demonstrations, _, path = retrieve()
    axis = plt.figure().gca()
    draw_demonstrations(axis, demonstrations)
    draw_path(axis, path)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
