"""The site: ``make docs`` builds it, warnings are errors, nothing is fetched."""

import re
import sys
from importlib.metadata import version as installed
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_extensions"), str(HERE.parent), str(HERE.parent / "demos")]

import benchmarks  # noqa: E402
import equations  # noqa: E402
import gallery_pages  # noqa: E402
import guides  # noqa: E402
import reference  # noqa: E402

from tpsim import gallery  # noqa: E402

project = "tpsim"
author = "the authors of tpsim"
copyright = "the authors of tpsim, Apache-2.0"
version = release = installed("tpsim")

extensions = [
    "mathml",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "_made", "**/README.rst", "gallery/**/*.ipynb"]
html_math_renderer = "mathml"
templates_path: list[str] = []

myst_enable_extensions = ["attrs_inline", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE / "_build" / "notebooks")
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_merge_streams = True

autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_param = False
napoleon_use_rtype = False

gallery.folder = lambda: gallery_pages.PICTURES  # as a user sees it, with no path before it
gallery_pages.lay_out(HERE / "_made" / "demos")
sphinx_gallery_conf = {
    "examples_dirs": "_made/demos",
    "gallery_dirs": "gallery",
    "filename_pattern": "",
    "image_scrapers": ("gallery_pages.picture",),
    "subsection_order": [f"_made/demos/{key}" for key in gallery_pages.SECTIONS],
    "within_subsection_order": "gallery_pages.InOrder",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e6,
    "write_computation_times": False,
    "reset_modules": ("gallery_pages.know_its_file",),
    "remove_config_comments": True,
    "thumbnail_size": (480, 300),
}

html_theme = "furo"
html_title = "tpsim"
html_static_path = ["_static"]
html_css_files = ["tpsim.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
html_favicon = "_static/favicon.svg"
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "monokai"

MADE = {
    "api": reference.directives,
    "benchmarks": benchmarks.page,
    "equations": equations.page,
    "guides": guides.rest,
}
"""What stands in place of ``<!-- made: NAME ARGUMENTS -->`` on a page."""


def fill(app, docname: str, source: list[str]) -> None:
    """Put in what is made from the code; demos get their titles."""
    name = docname.rsplit("/", 1)[-1]
    if docname.startswith("gallery/") and name != "index":
        source[0] = gallery_pages.titled(name, source[0])
    made = r"<!-- made: (\w+)((?: \w+)*) -->"
    source[0], count = re.subn(made, lambda m: MADE[m[1]](*m[2].split()), source[0])
    if count:
        app.env.note_reread()  # the code may change while the page does not


def leave_out(app, what: str, name: str, value: object, skip: bool, options) -> bool | None:
    """Fields whose default is a function of others have no documentation of their own."""
    home = getattr(value, "__module__", None) or ""
    return True if callable(value) and not home.startswith("tpsim") else None


def setup(app) -> None:
    """Hooks of this site."""
    app.connect("autodoc-skip-member", leave_out)
    app.connect("source-read", fill)
