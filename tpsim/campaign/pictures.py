"""Pictures of campaigns: force over displacement, compliance round the hand."""

import numpy as np
from matplotlib.figure import Figure

from tpsim.campaign.rows import Rows
from tpsim.study.canvas import INK, colours, legend, new_figure

_SECTORS = 12


def force_displacement(rows: Rows, by: str) -> Figure | None:
    """Displacement at most over the force, mean and 10 to 90 % of the trials; None of one force."""
    if "force_N" not in rows or len(np.unique(rows["force_N"])) < 2:
        return None
    figure, (axis,) = new_figure(height=3.0)
    names = rows.values(by)
    for name, colour in zip(names, colours(names), strict=True):
        own = rows.where((rows[by] == name) & np.isfinite(rows["displacement_max_mm"]))
        force, way = own["force_N"], own["displacement_max_mm"]
        if not len(force):
            continue
        edges = np.unique(np.quantile(force, np.linspace(0, 1, 9)))
        which = np.clip(np.searchsorted(edges, force, side="right") - 1, 0, len(edges) - 1)
        there = [k for k in range(len(edges)) if (which == k).any()]
        x = [force[which == k].mean() for k in there]
        low, middle, high = (
            [f(way[which == k]) for k in there]
            for f in (lambda w: np.quantile(w, 0.1), np.mean, lambda w: np.quantile(w, 0.9))
        )
        axis.plot(x, middle, "o-", color=colour, lw=1.6, ms=3.5, label=name)
        axis.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
    axis.set_xlabel("force [N]", color=INK)
    axis.set_ylabel("displacement at most [mm]", color=INK)
    axis.set_ylim(bottom=0)
    legend(axis)
    return figure


def compliance(rows: Rows, by: str) -> Figure | None:
    """Compliance [mm/N] by direction in the horizontal plane, with the commanded one over it.

    Measured: displacement along the force at the end of a push, over the force. Commanded: the
    ellipse of ``u^T K^-1 u`` with the hand's stiffness K when the push begins, mean over the
    trials; where K has no inverse, nothing is commanded.
    """
    if "force_x_N" not in rows:
        return None
    level = np.hypot(rows["force_x_N"], rows["force_y_N"]) > 0.7 * rows["force_N"]
    rows = rows.where(level & np.isfinite(rows["displacement_end_mm"]) & (rows["force_N"] > 0))
    if len(rows) < 2:
        return None
    figure = Figure(figsize=(4.6, 4.2))
    axis = figure.add_subplot(projection="polar")
    names = rows.values(by)
    for name, colour in zip(names, colours(names), strict=True):
        own = rows.where(rows[by] == name)
        angle = np.arctan2(own["force_y_N"], own["force_x_N"])
        soft = np.maximum(own["displacement_end_mm"] / own["force_N"], 0.0)
        axis.plot(angle, soft, ".", color=colour, ms=2.5, alpha=0.35)
        sector = np.round(angle / (2 * np.pi) * _SECTORS).astype(int) % _SECTORS
        there = [k for k in range(_SECTORS) if (sector == k).any()]
        x = [2 * np.pi * k / _SECTORS for k in there]
        middle = [float(np.median(soft[sector == k])) for k in there]
        axis.plot([*x, x[0]], [*middle, middle[0]], "o-", color=colour, ms=3, lw=1.4, label=name)
        if (ellipse := _commanded(own)) is not None:
            axis.plot(*ellipse, "--", color=colour, lw=1.2)
    axis.set_title("compliance [mm/N], horizontal; dashed: commanded", fontsize=9, color=INK)
    axis.legend(fontsize=8, frameon=False, loc="lower left", bbox_to_anchor=(-0.15, -0.15))
    return figure


def _commanded(rows: Rows) -> tuple[np.ndarray, np.ndarray] | None:
    """Angles and commanded compliance [mm/N] in the horizontal plane; None without stiffness."""
    if "stiffness_xx_N_m" not in rows:
        return None
    K = np.empty((len(rows), 3, 3))
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        K[:, i, j] = K[:, j, i] = rows[f"stiffness_{'xyz'[i]}{'xyz'[j]}_N_m"]
    K = K[np.isfinite(K).all((1, 2))]
    values = np.linalg.eigvalsh(K) if len(K) else np.zeros((0, 3))
    K = K[values[:, 0] > 1e-6 * np.maximum(values[:, -1], 1e-12)]
    if not len(K):
        return None
    turn = np.linspace(0, 2 * np.pi, 73)
    u = np.stack((np.cos(turn), np.sin(turn), np.zeros_like(turn)), axis=1)
    soft = 1e3 * np.einsum("ta,kab,tb->kt", u, np.linalg.inv(K), u)
    return turn, np.median(soft, axis=0)
