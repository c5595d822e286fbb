"""Draw docs/manifolds.png: a product on the sphere, and docks that are turned as never shown.

Run it after its numbers have changed: ``python docs/draw_manifolds.py``.
"""

import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib.figure import Figure

from tpsim import S2, S3, RiemannianGaussian, gaussian_product, rotation
from tpsim.plot.style import PALETTE, panels

HERE = Path(__file__).parent


def sphere(axis):
    """Two Gaussians on S2 and their product, seen from the front."""
    ring = np.linspace(0, 2 * np.pi, 200)
    axis.plot(np.cos(ring), np.sin(ring), color="0.7", lw=1)
    ends = [
        S2.exp([0.0, 0, 1], a * np.array([np.cos(t), np.sin(t)]))
        for a, t in ((1.1, 2.8), (1.0, 0.1))
    ]
    factors = [
        RiemannianGaussian(S2, end, np.diag(spread) ** 2)
        for end, spread in zip(ends, ((0.12, 0.35), (0.3, 0.1)), strict=True)
    ]
    found = gaussian_product(factors)
    for g, colour in zip((*factors, found), PALETTE, strict=False):
        circle = np.column_stack([np.cos(ring), np.sin(ring)])
        for scale in (1, 2):
            outline = S2.exp(g.mean, scale * circle @ np.linalg.cholesky(g.covariance).T)
            outline[outline[:, 2] < 0] = np.nan
            axis.plot(*outline[:, :2].T, color=colour, lw=1.5)
        axis.plot(*g.mean[:2], "o", color=colour, ms=4)
    axis.set(xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal")
    axis.axis("off")


def turned(axis):
    """Angles from both docks along the movement between docks that are 179 degrees apart."""
    (code,) = re.findall(r"```python\n(.*?)```", (HERE / "manifolds.md").read_text(), re.S)
    names = {}
    exec(code, names)
    docks = names["docks"](names["turned"], 0.3)
    for dock, label, colour in zip(docks, ("first", "second"), PALETTE, strict=False):
        place = rotation.to_quaternion(dock.A)
        taught = names["views"][docks.index(dock)].reshape(8, 100, 8)
        for view in taught:
            away = S3.distance(np.eye(4)[0], view[:, 4:])
            axis.plot(names["time"], np.degrees(away), color=colour, lw=0.6, alpha=0.5)
        away = S3.distance(names["path"].mean[:, 3:], place)
        axis.plot(
            names["time"], np.degrees(away), color=colour, lw=2, label=f"from the {label} dock"
        )
    axis.set(xlabel="time", ylabel="angle of the hand [deg]")
    axis.legend(frameon=False)


def main():
    """Two panels."""
    figure = Figure()
    left, right = panels(figure, 1, 2, kind=["plane", "curve"], size=(4.2, 3.2))
    sphere(left)
    turned(right)
    figure.savefig(HERE / "manifolds.png", dpi=110)


if __name__ == "__main__":
    main()
