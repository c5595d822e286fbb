"""Trials in 3-D inside a report: one viewer, and what it plays."""

import html
import json
import re
from collections.abc import Mapping
from importlib import resources

from tpsim.errors import SimulationError, TpsimError, one_line
from tpsim.film.clip import Clip
from tpsim.film.offline import FACES, pages

LARGEST = 3_000_000
"""Characters that all of it has, at most."""

NONE = "Trials are not shown in 3-D here"

_DATA = re.compile(r'(?<=window\.__VISER_EMBED_DATA__=")[^"]*')


def embedded(clips: Mapping[str, Clip]) -> str:
    """A part of a report in which people choose a clip, turn it and play it.

    Parameters
    ----------
    clips : mapping of str to Clip
        All of one world, by what people choose; none give a part that is empty.

    Returns
    -------
    str
        HTML; where it cannot be made, a line that says why.
    """
    if not clips:
        return ""
    try:
        for faces in (FACES, FACES // 2, FACES // 6):
            part = _part(list(clips), pages(list(clips.values()), faces))
            if len(part) < LARGEST:
                return part
        raise SimulationError(f"they take {len(part) / 1e6:.1f} MB, and {LARGEST / 1e6:g} are room")
    except (TpsimError, OSError) as error:
        return f'<p class="hint">{NONE}: {html.escape(one_line(error))}</p>'


def _part(names: list[str], whole: list[str]) -> str:
    """One viewer is enough: pages differ in what they play alone."""
    matches = [_DATA.search(page) for page in whole]
    if not all(matches):
        raise SimulationError("this version of viser has other pages; install viser 1.1")
    first = matches[0]
    assert first is not None
    viewer = [whole[0][: first.start()], whole[0][first.end() :]]
    played = [match[0] for match in matches if match is not None]
    held = json.dumps({"viewer": viewer, "played": played}).replace("<", "\\u003c")
    buttons = "".join(
        f'<button type="button" data-clip="{k}">{html.escape(name)}</button>'
        for k, name in enumerate(names)
    )
    script = resources.files("tpsim.study").joinpath("embedded.js").read_text(encoding="utf-8")
    return (
        f'<section class="in-3d">\n<h2>In 3-D</h2>\n<p class="choice">{buttons}</p>\n'
        '<iframe title="A trial in 3-D" hidden></iframe>\n'
        f'<script type="application/json">{held}</script>\n<script>\n{script}</script>\n</section>'
    )
