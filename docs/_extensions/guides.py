"""The navigation takes every page of ``docs/``: what no list names stands under "More"."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1]


def rest() -> str:
    """Pages that no toctree of the landing page names, as lines of one."""
    listed = set(re.findall(r"^([\w/-]+)$", (DOCS / "index.md").read_text("utf-8"), re.M))
    pages = {page.stem for page in DOCS.glob("*.md")} - listed - {"index"}
    return "\n".join(sorted(pages))
