"""Tables for papers."""

from collections.abc import Mapping, Sequence

DASH = "–"
"""Where there is no number."""


def tabular(rows: Sequence[Mapping[str, object]]) -> str:
    """Rows as a LaTeX tabular with rules of booktabs."""
    heads = list(dict.fromkeys(head for row in rows for head in row))
    lines = [
        r"\begin{tabular}{l" + "r" * (len(heads) - 1) + "}",
        r"\toprule",
        " & ".join(map(_tex, heads)) + r" \\",
        r"\midrule",
        *(" & ".join(_tex(row.get(head, "")) for head in heads) + r" \\" for row in rows),
        r"\bottomrule",
        r"\end{tabular}",
    ]
    return "\n".join(lines) + "\n"


def _tex(value: object) -> str:
    text = str(value)
    for character in "&%_#":
        text = text.replace(character, "\\" + character)
    return text.replace(DASH, "--")
