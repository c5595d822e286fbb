"""The report: one HTML file that holds everything, figures, film, and how to repeat it."""

import base64
import html
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import TypeGuard

import numpy as np
from matplotlib.figure import Figure

from tpsim.study.canvas import to_svg
from tpsim.study.measure import Result
from tpsim.versions import versions
from tpsim.whole import write_text

NO_FILM = "There is no film. To see why, type tpsim doctor; it was perhaps not asked for."


@dataclass(frozen=True)
class Picture:
    """A figure, an image (H, W, 3) of bytes or a PNG file, with what there is to see on it."""

    content: Figure | np.ndarray | Path
    caption: str = ""


@dataclass(frozen=True)
class Section:
    """A part of a report: a title, paragraphs parted by empty lines, pictures, a table.

    ``table`` is a sequence of rows with equal keys, which become its heading.
    """

    title: str
    text: str = ""
    pictures: Sequence[Picture] = ()
    table: Sequence[Mapping[str, object]] = ()


def write_report(
    path: Path,
    *,
    title: str,
    command: str,
    sections: Sequence[Section] = (),
    figures: Sequence[Result] = (),
    film: Path | None = None,
    no_film: str = NO_FILM,
    in_3d: str = "",
    lead: str = "",
    notes: Sequence[str] = (),
    about: Mapping[str, object] | None = None,
    refresh: str = "",
) -> Path:
    """Write a report as one HTML file without anything outside it, in place of an earlier one.

    Parameters
    ----------
    path : Path
        The file to write.
    title : str
        Its heading.
    command : str
        The command line that repeats what is reported.
    sections : sequence of Section
        What ran and what came out.
    figures : sequence of Result
        The table of figures, with limits and whether they are kept.
    film : Path, optional
        An MP4 file to embed.
    no_film : str
        What to say without it: why there is none, and how to get one.
    in_3d : str
        HTML of :func:`tpsim.study.embedded.embedded`.
    lead : str
        The opening paragraph.
    notes : sequence of str
        Remarks for the end.
    about : mapping, optional
        Facts for the line under the title: seed, trials, date.
    refresh : str
        Seconds after which a browser loads the page again; never by default.

    Returns
    -------
    Path
        ``path``.
    """
    body = "\n".join(
        (
            _header(title, lead, about or {}, figures),
            _film(film, no_film),
            in_3d,
            _figures_table(figures),
            *map(_section, sections),
            _notes(notes),
            _repeat(command),
        )
    )
    style = resources.files("tpsim.study").joinpath("report.css").read_text(encoding="utf-8")
    again = f'<meta http-equiv="refresh" content="{_safe(refresh)}">\n' if refresh else ""
    page = (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"{again}<title>{_safe(title)}</title>\n<style>\n{style}</style>\n</head>\n"
        f"<body>\n<main>\n{body}\n</main>\n</body>\n</html>\n"
    )
    return write_text(Path(path), page, replace=True)


def _header(title: str, lead: str, about: Mapping[str, object], figures: Sequence[Result]) -> str:
    facts = [f"<span>{_safe(key)} <b>{_safe(value)}</b></span>" for key, value in about.items()]
    judged = [figure.passed for figure in figures if figure.passed is not None]
    if judged:
        kind = "pass" if all(judged) else "fail"
        facts.append(f'<span class="{kind}">{sum(judged)} of {len(judged)} limits kept</span>')
    opening = f'<p class="lead">{_safe(lead)}</p>\n' if lead else ""
    return (
        f'<header>\n<p class="brand">tpsim</p>\n<h1>{_safe(title)}</h1>\n{opening}'
        f'<p class="facts">{"".join(facts)}</p>\n</header>'
    )


def _film(film: Path | None, hint: str) -> str:
    if film is None:
        return f'<p class="hint">{_safe(hint)}</p>' if hint else ""
    source = _data_uri(Path(film).read_bytes(), "video/mp4")
    return (
        '<figure class="film"><video controls muted loop playsinline preload="auto" '
        f'src="{source}"></video></figure>'
    )


def _figures_table(figures: Sequence[Result]) -> str:
    if not figures:
        return ""
    rows = "\n".join(map(_figures_row, figures))
    return (
        '<section>\n<h2>Figures</h2>\n<table class="figures">\n<thead><tr><th>measure</th>'
        '<th class="number">value</th><th></th><th class="number">limit</th><th></th><th></th>'
        f"</tr></thead>\n<tbody>\n{rows}\n</tbody>\n</table>\n</section>"
    )


def _figures_row(result: Result) -> str:
    limit = meter = verdict = ""
    if result.limit is not None:
        sign = "≥" if result.at_least else "≤"
        kind = "pass" if result.passed else "fail"
        limit = f"{sign} {_number(result.limit)}"
        verdict = f'<span class="{kind}">{"kept" if result.passed else "missed"}</span>'
        meter = _meter(result, kind)
    return (
        f'<tr><td>{_safe(result.title)}</td><td class="number"><b>{_number(result.value)}</b></td>'
        f'<td class="unit">{_safe(result.unit)}</td>'
        f'<td class="number">{limit}</td><td>{meter}</td><td>{verdict}</td></tr>'
    )


def _meter(result: Result, kind: str) -> str:
    """Draw a bar whose mark is the limit, at two thirds of its length."""
    if result.value is None or not result.limit or not np.isfinite(result.value):
        return ""
    share = min(max(result.value / result.limit, 0.0) * 200 / 3, 100.0)
    return f'<span class="meter {kind}"><i style="width:{share:.1f}%"></i></span>'


def _section(section: Section) -> str:
    paragraphs = [f"<p>{_safe(part)}</p>" for part in section.text.split("\n\n") if part.strip()]
    pictures = map(_picture, section.pictures)
    return "\n".join(
        (
            "<section>",
            f"<h2>{_safe(section.title)}</h2>",
            *paragraphs,
            *pictures,
            _table(section.table),
            "</section>",
        )
    )


def _picture(picture: Picture) -> str:
    content = picture.content
    if isinstance(content, Figure):
        inner = to_svg(content)
    else:
        png = content.read_bytes() if isinstance(content, Path) else _encode(content)
        inner = f'<img alt="{_safe(picture.caption)}" src="{_data_uri(png, "image/png")}">'
    caption = f"<figcaption>{_safe(picture.caption)}</figcaption>" if picture.caption else ""
    return f"<figure>{inner}{caption}</figure>"


def _table(rows: Sequence[Mapping[str, object]]) -> str:
    if not rows:
        return ""
    heads = list(dict.fromkeys(key for row in rows for key in row))
    head = "".join(_cell(name, "th", _is_number(rows[0].get(name))) for name in heads)
    lines = ["".join(_cell(row.get(name, "")) for name in heads) for row in rows]
    body = "\n".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"


def _cell(value: object, tag: str = "td", right: bool | None = None) -> str:
    kind = ' class="number"' if (_is_number(value) if right is None else right) else ""
    return f"<{tag}{kind}>{_number(value) if _is_number(value) else _safe(value)}</{tag}>"


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _notes(notes: Sequence[str]) -> str:
    if not notes:
        return ""
    items = "\n".join(f"<li>{_safe(note)}</li>" for note in notes)
    return f"<section>\n<h2>Notes</h2>\n<ul>\n{items}\n</ul>\n</section>"


def _repeat(command: str) -> str:
    packages = ("tpsim", "mujoco", "pin", "numpy", "scipy")
    shown = ", ".join(f"{name} {version}" for name, version in versions(packages).items())
    return (
        "<footer>\n<h2>Repeat it</h2>\n"
        f'<pre><code>{_safe(command)}</code></pre>\n<p class="versions">{_safe(shown)}</p>\n'
        "</footer>"
    )


def _number(value: float | None) -> str:
    if value is None or not np.isfinite(value):
        return "–"
    if float(value).is_integer() and abs(value) < 1e6:
        return f"{value:.0f}"
    return f"{value:.3g}".replace("-", "−")


def _encode(image: np.ndarray) -> bytes:
    from matplotlib.image import imsave

    file = io.BytesIO()
    imsave(file, np.ascontiguousarray(image), format="png")
    return file.getvalue()


def _data_uri(content: bytes, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _safe(text: object) -> str:
    return html.escape(str(text))
