"""One HTML file with the tables and pictures of a comparison."""

from collections.abc import Sequence
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
}

READING = (
    "rms, end: metres from the teacher's path and end, [95 % bootstrap intervals over the same "
    "situations for all methods]; at the farthest distance: direction [deg] of the approach, nll "
    "[nats per sample, median], shares of a demonstration's samples inside the 50 and 95 % tubes, "
    "log dimensionless jerk (lower is smoother). train and adapt are processor times; rank and "
    "wins are by rms over all situations."
)


def write_comparison_report(
    path: Path, results: Results, pictures: Sequence[Path], command: str
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
    if failed := failures(results):
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
