"""Fronts on paper: what controllers come to in a contest, as figures and tables of a report."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from tpsim.study.canvas import INK, PALETTE, new_figure
from tpsim.study.contest import Contest, Error
from tpsim.study.record import Records
from tpsim.study.report import Picture, Section
from tpsim.study.standing import FORCE, LEARNED, WAY, YIELD, Standing

_PLACES = ((7, 0), (-7, 0), (7, 10), (7, -10), (-7, 10), (-7, -10), (7, 20), (7, -20))
"""Where a name may stand by its point [points]."""

Spot = tuple[float, float, float]
"""Across, and of the error 95 % and largest."""


def front(
    spots: Mapping[str, Spot], *, across: str, label: str, more_is_better: bool = True
) -> Figure:
    """Draw errors over what they cost: a point for each controller, a line up to its worst trial.

    Learned controllers are joined, in the order in which they are given; the arrow points to where
    both are better.

    Parameters
    ----------
    spots : mapping of str to (float, float, float)
        Across, error of 95 % of the trials, largest error. Both axes are logarithmic.
    across, label : str
        Names and units of the axes.
    more_is_better : bool
        Whether large values across are better, such as yield, or small ones, such as force.
    """
    figure, (axis,) = new_figure(height=3.6)
    learned = sorted(x for name, x in spots.items() if name.startswith(LEARNED))
    axis.plot(*(np.array([(x[0], x[1]) for x in learned]).reshape(-1, 2).T), color=PALETTE[0], lw=1)
    for name, (x, wide, most) in spots.items():
        colour = PALETTE[0] if name.startswith(LEARNED) else PALETTE[1]
        axis.plot([x, x], [wide, most], color=colour, lw=1.2, alpha=0.6)
        marker = "o" if name == LEARNED else "." if name.startswith(LEARNED) else "s"
        axis.plot(x, wide, marker, color=colour, ms=6)
    _logarithmic(axis, [s[0] for s in spots.values()], [e for s in spots.values() for e in s[1:]])
    axis.set_xlabel(across, color=INK)
    axis.set_ylabel(label, color=INK)
    _better(axis, more_is_better)
    _name(axis, spots)
    return figure


def _name(axis: Axes, spots: Mapping[str, Spot]) -> None:
    """Write every name where it covers no other one, if there is such a place by its point."""
    axis.figure.draw_without_rendering()  # type: ignore[union-attr]
    places = axis.transData.transform([spot[:2] for spot in spots.values()])
    taken = [Bbox.from_bounds(x - 4, y - 4, 8, 8) for x, y in places]
    for name, (x, wide, _) in spots.items():
        text = name.removeprefix(f"{LEARNED}, ")
        for dx, dy in _PLACES:
            note = axis.annotate(
                text,
                (x, wide),
                xytext=(dx, dy),
                textcoords="offset points",
                ha="left" if dx > 0 else "right",
                va="center",
                fontsize=8,
                color=INK,
            )
            box = note.get_window_extent()
            if not any(box.overlaps(other) for other in taken):
                break
            if (dx, dy) != _PLACES[-1]:
                note.remove()
        taken.append(box)


def _logarithmic(axis: Axes, across: Sequence[float], errors: Sequence[float]) -> None:
    """Scales with plain numbers, and room for the names."""
    for side, values, room in ((axis.xaxis, across, 1.6), (axis.yaxis, errors, 1.25)):
        low, high = min(values), max(values)
        scale = axis.set_xscale if side is axis.xaxis else axis.set_yscale
        limits = axis.set_xlim if side is axis.xaxis else axis.set_ylim
        scale("log")
        limits(low / 1.25, high * room)
        ticks = _ticks(low / 1.25, high * room)
        side.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
        side.set_ticks([], minor=True)


def _ticks(low: float, high: float) -> list[float]:
    steps = [m * 10.0**k for k in range(-4, 6) for m in (1, 2, 5)]
    return [step for step in steps if low <= step <= high]


def _better(axis: Axes, more_is_better: bool) -> None:
    """An arrow into the corner where both are better."""
    x, away = (0.97, 0.86) if more_is_better else (0.03, 0.14)
    axis.annotate(
        "",
        (x, 0.04),
        xytext=(away, 0.18),
        xycoords="axes fraction",
        textcoords="axes fraction",
        arrowprops={"arrowstyle": "-|>", "color": INK, "alpha": 0.6},
    )
    axis.text(
        away,
        0.2,
        "better",
        transform=axis.transAxes,
        ha="center",
        fontsize=8,
        color=INK,
        style="italic",
    )


def sections(contest: Contest, records: Records) -> list[Section]:
    """Table of all controllers, and fronts of every error over yield and over force."""
    standing, figures = contest.standing(records), []
    if len(standing.points) < 2:
        return []
    for error in contest.errors:
        name = f"{error.title or error.name} [{error.unit}]"
        for key, across, more in (
            (YIELD, "the pushed hand gives way [mm]", True),
            (FORCE, "force to lead the hand the same way [N]", False),
        ):
            spots = _spots(standing, error, key)
            if len(spots) > 1:
                figure = front(spots, across=across, label=name, more_is_better=more)
                figures.append(Picture(figure))
    text = _text(standing) + "\n\n" + _experts(contest)
    return [Section("Beside experts", text, figures, _rows(contest, standing))]


def _spots(standing: Standing, error: Error, key: str) -> dict[str, Spot]:
    found = {}
    for name, point in standing.points.items():
        across = point[key]
        wide, most = (point[f"{error.name}_{part}_{error.unit}"] for part in ("p95", "max"))
        led = key != FORCE or standing.led(name)
        if across and wide and most and np.isfinite(most) and led:
            found[name] = (across, wide, most)
    return found


def _rows(contest: Contest, standing: Standing) -> list[dict[str, object]]:
    rows = []
    for name, point in standing.points.items():
        row: dict[str, object] = {"controller": name}
        for error in contest.errors:
            for part, words in (("p95", "95 %"), ("max", "largest")):
                value = point[f"{error.name}_{part}_{error.unit}"]
                row[f"{error.title or error.name} [{error.unit}], {words}"] = _number(value)
        row["yield [mm]"] = _number(point[YIELD])
        if point[FORCE] is not None:
            far = standing.led(name)
            row["force [N]"] = _number(point[FORCE]) if far else f"more than {point[FORCE]:.0f}"
            row["led [mm]"] = _number(point[WAY])
        row["touched"] = _number(point["contacts"])
        row["dominated by"] = ", ".join(standing.dominated[name]) or "none"
        rows.append(row)
    return rows


def _number(value: float | None) -> object:
    return "–" if value is None else value


def _text(standing: Standing) -> str:
    pushes = {int(point["pushes"] or 0) for point in standing.points.values()}
    return (
        f"Every controller met the same {max(pushes)} pushes. Errors are the largest of a trial "
        "while pushed; 95 % of the trials keep below the square, all below the end of its line. "
        "Yield is the mean over the pushes of the largest way that the hand gives. The force is "
        "the mean that a person feels who leads the hand the same way under each controller; where "
        "the hand went less than nine tenths of the farthest one's way it is more than that. A "
        "controller is dominated by another one that errs no more in anything, yields no less, "
        "touches nothing in more trials, and is better in one."
    )


def _experts(contest: Contest) -> str:
    if not contest.experts:
        return ""
    gains = "; ".join(
        f"{name}: "
        + ", ".join(
            f"{gain} {value:g} {expert.ranges[gain].unit}".strip()
            for gain, value in expert.gains.items()
        )
        for name, expert in contest.experts.items()
    )
    tuned = (
        "were tuned by tpsim tune, on situations of other seeds, to the least error that goes with "
        f"a yield of {contest.yielding:g} mm"
    )
    if contest.gains is None or not contest.gains.is_file():
        tuned = "are the middle of their ranges: nobody has tuned them yet (tpsim tune)"
    return (
        "The experts know the task and were told nothing of what was learned. Their gains "
        f"{tuned}: {gains}."
    )
