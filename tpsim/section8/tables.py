"""Results as files: CSV of everything, JSON of the summary, LaTeX of the table in a paper."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tpsim.section8.results import Results
from tpsim.section8.statistics import Estimate, ratio_to_best
from tpsim.study.latex import DASH
from tpsim.study.summary import plain
from tpsim.whole import write_text

Row = dict[str, str]


def write_csv(path: Path, rows: Sequence[Mapping[str, object]]) -> Path:
    """Write rows of equal keys; NaN, where a method has no such figure, is left empty."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    for row in plain(list(rows)):
        writer.writerow({key: "" if value is None else value for key, value in row.items()})
    return write_text(path, text.getvalue(), replace=True)


def write_json(path: Path, result: Mapping[str, object]) -> Path:
    """Write plain values; NaN becomes null."""
    return write_text(
        path, json.dumps(plain(result), indent=1, allow_nan=False) + "\n", replace=True
    )


def short(result: Mapping[str, object]) -> dict[str, object]:
    """Result of a comparison for people: one line for every method, and the paths."""
    columns = ("rms", "end", "direction", "train_ms", "adapt_us", "rank", "wins", "reason")
    methods = result["methods"]
    assert isinstance(methods, Mapping)
    rows = [
        {"method": name} | {key: figures.get(key, "") for key in columns}
        for name, figures in methods.items()
    ]
    return {"methods": rows, "paths": result["paths"]}


def main_table(results: Results) -> list[Row]:
    """One row per method of the headline: rms by distance, then the other figures."""
    family, count = results.headline
    rank, wins = results.ranks(family, count)
    estimates = {d: results.estimate(family, count, d, "rms") for d in results.plan.distances}
    far = results.plan.distances[-1]
    others = {
        name: results.estimate(family, count, far, name).mean
        for name in ("end", "direction", "nll", "inside_50", "inside_95", "jerk")
    }
    near = 1.0 if 1.0 in results.plan.distances else results.plan.distances[0]
    end_near = results.estimate(family, count, near, "end").mean
    costs = {n: results.costs(family, count, n) for n in ("train_ms", "adapt_us", "parameters")}
    return [
        {"method": name}
        | {f"rms {d:g}x": interval(e, m) for d, e in estimates.items()}
        | {f"end {near:g}x": rounded(end_near[m]), f"end {far:g}x": rounded(others["end"][m])}
        | {
            "direction": rounded(others["direction"][m], 1),
            "nll": rounded(others["nll"][m], 1),
            "50 %": rounded(others["inside_50"][m], 2),
            "95 %": rounded(others["inside_95"][m], 2),
            "jerk": rounded(others["jerk"][m], 1),
            "train ms": rounded(costs["train_ms"][m], 0),
            "adapt us": rounded(costs["adapt_us"][m], 0),
            "parameters": rounded(costs["parameters"][m], 0),
            "rank": rounded(rank[m], 1),
            "wins": f"{wins[m]:.0%}",
        }
        for m, name in enumerate(results.methods)
    ]


def family_table(results: Results) -> list[Row]:
    """One row per method: rms at the farthest distance, by family and demonstrations."""
    far = results.plan.distances[-1]
    columns = {
        f"{family}, {count}": results.estimate(family, count, far, "rms")
        for family in results.plan.families
        for count in results.plan.counts
    }
    return [
        {"method": name} | {title: rounded(e.mean[m]) for title, e in columns.items()}
        for m, name in enumerate(results.methods)
    ]


def ratio_table(results: Results) -> list[Row]:
    """One row per method: rms relative to the best method, by distance, with paired intervals."""
    family, count = results.headline
    columns = {}
    for d in results.plan.distances:
        best, ratios = ratio_to_best(results.values(family, count, d, "rms"))
        name = "none" if best is None else results.methods[best]
        columns[f"{d:g}x (best: {name})"] = ratios
    return [
        {"method": name} | {title: interval(e, m, 2) for title, e in columns.items()}
        for m, name in enumerate(results.methods)
    ]


def closed_loop_table(results: Results) -> list[Row]:
    """One row per method on an arm [mm]: by distance, and what pushes did at the farthest."""
    family, count = results.headline
    near, far = results.plan.distances[0], results.plan.distances[-1]

    def mean(distance: float, figure: str) -> NDArray:
        return results.estimate(family, count, distance, figure).mean

    rms = {d: results.estimate(family, count, d, "rms") for d in (near, far)}
    ends = {d: mean(d, "end") for d in (near, far)}
    pushed = {name: mean(far, name) for name in ("end_pushed", "tracking", "yield", "saturated")}
    outcomes = results.values(family, count, None, "diverged")
    return [
        {"method": name}
        | {f"rms {d:g}x": interval(e, m, 1) for d, e in rms.items()}
        | {f"end {d:g}x": rounded(e[m], 1) for d, e in ends.items()}
        | {figure.replace("_", " "): rounded(values[m], 1) for figure, values in pushed.items()}
        | {
            "refused": str(int(np.isnan(outcomes[m]).sum())),
            "diverged": str(int((outcomes[m] == 1).sum())),
        }
        for m, name in enumerate(results.methods)
    ]


def interval(estimate: Estimate, m: int, digits: int = 3) -> str:
    """Mean with its 95 % interval, as text."""
    mean, low, high = estimate.mean[m], estimate.low[m], estimate.high[m]
    if not np.isfinite(mean):
        return DASH
    return f"{mean:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def rounded(value: float, digits: int = 3) -> str:
    """Number as text; a dash where there is none, powers of ten where it is huge."""
    if not np.isfinite(value):
        return DASH
    return f"{value:.{digits}f}" if abs(value) < 1e5 or digits == 0 else f"{value:.0e}"
