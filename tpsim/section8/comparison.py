"""The comparison of Section 8: learn, retrieve, measure, and write it all down."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from tpsim.errors import ArgumentError
from tpsim.section8 import pictures, tables
from tpsim.section8.families import FAMILIES
from tpsim.section8.folder import check_folder
from tpsim.section8.method import Method
from tpsim.section8.methods import METHODS, PICTURED
from tpsim.section8.plan import Plan
from tpsim.section8.report import write_comparison_report
from tpsim.section8.results import Results
from tpsim.section8.run import run
from tpsim.study.canvas import to_png
from tpsim.study.latex import tabular
from tpsim.whole import write_bytes, write_text
from tpsim.world.threads import one_thread


@one_thread()
def compare(
    methods: Mapping[str, Method] = METHODS,
    plan: Plan | None = None,
    *,
    seed: int = 0,
    folder: Path,
    workers: int = 1,
    progress: bool = False,
    command: str = "tpsim compare",
    arms: Mapping[str, Plan] | None = None,
) -> dict[str, object]:
    """Compare methods on the same demonstrations and in the same situations.

    Parameters
    ----------
    methods
        By name, such as ``{**METHODS, "mine": f}``: f learns from a list of demonstrations and
        returns a function from the frames of a situation to the movement, a Gaussian (T, D) or
        an array (T, D). One that raises becomes a row with its reason.
    plan
        How much to compare; by default everything, some minutes on two cores.
    seed
        Added to the seeds of the plan's teachers.
    folder
        Where to write: new, empty, or of a comparison. What it already holds of the same plan and
        methods is not done again; tables and pictures are drawn anew.
    workers
        Number of processes.
    progress
        Show a bar on standard error.
    command
        The command line that repeats it, for the report.
    arms
        What is also carried out on simulated arms, by the arm's name, such as
        :data:`tpsim.section8.closed_loop.PLANS`; nothing by default.

    Returns
    -------
    dict
        ``methods``: for every name its figures over all situations of the tutorial's own task,
        and ``reason`` where it failed; ``plan``; ``closed_loop``: the same by arm, in mm;
        ``paths`` of what was written.

    Raises
    ------
    ArgumentError
        No method, or a plan with nothing in it.
    RecordingError
        A folder of something else, or results in it that are damaged.
    """
    plan = (Plan() if plan is None else plan).from_seed(seed)
    _check(methods, plan)
    check_folder(folder)
    results = Results(plan, run(plan, methods, folder, workers, progress))
    closed: dict[str, Results] = {}
    if arms:
        from tpsim.section8.closed_loop import run_closed_loop

        plans = {name: each.from_seed(seed) for name, each in arms.items()}
        closed = run_closed_loop(methods, folder, plans, workers, progress)
    drawn = _pictures(results, methods, folder)
    if closed:
        picture = to_png(pictures.on_arms(closed), dpi=110)
        drawn.append(write_bytes(folder / "closed-loop.png", picture, replace=True))
    main = tables.main_table(results)
    rows = [row for each in (results, *closed.values()) for row in each.rows()]
    paths = {
        "folder": folder,
        "table": tables.write_csv(folder / "comparison.csv", rows),
        "latex": write_text(
            folder / "comparison.tex",
            "\n".join(map(tabular, [main, *map(tables.closed_loop_table, closed.values())])),
            replace=True,
        ),
        "pictures": drawn,
        "json": folder / "comparison.json",
        "report": folder / "report.html",
    }
    result: dict[str, object] = {"methods": results.summary(), "plan": asdict(plan)}
    if closed:
        result["closed_loop"] = {name: each.summary() for name, each in closed.items()}
    result["paths"] = paths
    tables.write_json(folder / "comparison.json", result)
    write_comparison_report(folder / "report.html", results, drawn, command, closed)
    return result


def _pictures(results: Results, methods: Mapping[str, Method], folder: Path) -> list[Path]:
    plan = results.plan
    (family, count), seed = results.headline, plan.seeds[0]
    situations = [
        FAMILIES[family].situations(1, distance, plan.samples, seed)[0]
        for distance in plan.distances
    ]
    taught = FAMILIES[family].demonstrations(count, plan.samples, seed)
    columns = [(taught, situation) for situation in situations]
    shown = {n: m for n, m in methods.items() if n in PICTURED or n not in METHODS}
    titles = [f"{distance:g} x the spread" for distance in plan.distances]
    figures = {
        "layout": pictures.layout(shown or methods, columns, titles),
        "error-against-distance": pictures.against_distance(results),
    }
    if len(plan.counts) > 1:
        far = plan.distances[-1]
        figures["error-against-demonstrations"] = pictures.against_demonstrations(results, far)
    paths = []
    for name, figure in figures.items():
        paths.append(write_bytes(folder / f"{name}.png", to_png(figure, dpi=110), replace=True))
    return paths


def _check(methods: Mapping[str, Method], plan: Plan) -> None:
    if not methods:
        raise ArgumentError("there is no method to compare; give at least one")
    if unknown := [family for family in plan.families if family not in FAMILIES]:
        raise ArgumentError(f"families {unknown} are not known; there are {', '.join(FAMILIES)}")
    if not (plan.families and plan.counts and plan.seeds and plan.distances):
        raise ArgumentError("the plan has nothing in it; see tpsim.section8.plan.Plan")
    if min(plan.counts) < 1 or plan.situations < 1 or plan.samples < 4:
        raise ArgumentError(
            f"the plan has counts {plan.counts}, {plan.situations} situations and {plan.samples} "
            "samples; the least are 1, 1 and 4"
        )
