"""One HTML file with the tables and pictures of a comparison."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from tpsim.section8 import tables
from tpsim.section8.families import FAMILIES
from tpsim.section8.results import Results
from tpsim.study.report import Picture, Section, write_report

CAPTIONS = {
    "layout": "Rows: methods; columns: situations ever farther from the demonstrations. Dashed: "
    "what the teacher does; faint: the demonstrations; shaded: one standard deviation.",
    "error-against-distance": "Distance from the teacher's path, with 95 % bootstrap intervals.",
    "error-against-demonstrations": "The same at the farthest distance, by demonstrations.",
    "closed-loop": "Distance of a simulated hand from the teacher's path, with 95 % intervals.",
}

CLOSED = (
    "What methods retrieve, carried out by the same LQT and impedance on {title}. In mm: "
    "distance of the hand's path from the teacher's, rms [95 % bootstrap intervals], and of its "
    "end; at the farthest distance: end after a push of {force:g} N, rms over time of the hand "
    "from what was retrieved (tracking), how far the push moved the hand (yield), and the share of "
    "time steps with a motor at its limit [%]. Of {trials} situations: refused by the method, or "
    "diverged."
)

READING = (
    "rms, end: metres from the teacher's path and end, [95 % bootstrap intervals over the same "
    "situations for all methods]; at the farthest distance: direction [deg] of the approach, nll "
    "[nats per sample, median], shares of a demonstration's samples inside the 50 and 95 % tubes, "
    "log dimensionless jerk (lower is smoother). train and adapt are processor times; rank and "
    "wins are by rms over all situations."
)


def write_comparison_report(
    path: Path,
    results: Results,
    pictures: Sequence[Path],
    command: str,
    closed: Mapping[str, Results] | None = None,
) -> Path:
    """Write the report of a comparison."""
    family, count = results.headline
    plan = results.plan
    sections = [
        Section(f"{family}, {count} demonstrations", READING, (), tables.main_table(results)),
        Section(
            "Pictures",
            pictures=[Picture(picture, CAPTIONS.get(picture.stem, "")) for picture in pictures],
        ),
        Section(
            "Relative to the best method", "rms, paired intervals.", (), tables.ratio_table(results)
        ),
        Section(
            f"All families, rms at {plan.distances[-1]:g} times the spread",
            " ".join(f"{name}: {FAMILIES[name].title}." for name in plan.families),
            (),
            tables.family_table(results),
        ),
    ]
    for arm, carried in (closed or {}).items():
        sections.append(_closed_section(arm, carried))
    failed = [row for each in (results, *(closed or {}).values()) for row in failures(each)]
    if failed:
        sections.append(Section("Failures", table=failed))
    return write_report(
        path,
        title="Which task-adaptive method generalises, how far, how fast",
        command=command,
        sections=sections,
        no_film="",
        about={
            "teachers": len(plan.seeds),
            "situations per distance": plan.situations * len(plan.seeds),
            "samples": plan.samples,
        },
    )


def _closed_section(arm: str, results: Results) -> Section:
    from tpsim.section8.arms import ARMS

    plan = results.plan
    trials = len(plan.seeds) * len(plan.distances) * plan.situations
    words = CLOSED.format(title=ARMS[arm].title, force=ARMS[arm].force, trials=trials)
    return Section(f"Closed loop: {arm}", words, (), tables.closed_loop_table(results))


def failures(results: Results) -> list[dict[str, object]]:
    """Methods that failed, where, and why."""
    rows: list[dict[str, object]] = []
    for family in results.plan.families:
        for count in results.plan.counts:
            for name, reason in results.reasons(family, count).items():
                rows.append(
                    {"family": family, "demonstrations": count, "method": name, "reason": reason}
                )
    return rows
