"""Pages: their links lead somewhere, their commands are understood, their Python runs."""

import ast
import json
import os
import re
import sys
from importlib import import_module
from pathlib import Path

import benchmarks
import gallery_pages
import guides
import numpy as np
import pytest
import reference

from tpsim import gallery

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(
    [ROOT / "README.md", *DOCS.glob("*.md"), *(DOCS / "recipes").glob("*.md"),
     *(DOCS / "api").glob("*.md"), *(DOCS / "notebooks").glob("*.md")]
)  # fmt: skip
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))

RUN_ELSEWHERE = {
    "deploy": "tests/deploy/test_page.py",
    "your-recordings": "tests/data/test_docs.py",
    "environments": "tests/test_readme.py",
    **dict.fromkeys(("comparison-method", "controller", "robot", "task", "view"),
                    "tests/test_recipes.py"),
}  # fmt: skip
"""Pages whose Python another test runs."""


def name(page):
    return page.relative_to(ROOT).as_posix()


def prose(page):
    """Text of a page or of the Markdown of a notebook, without its code blocks."""
    text = page.read_text()
    if page.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        text = "\n".join("".join(c["source"]) for c in cells if c["cell_type"] == "markdown")
    return re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)


def blocks(page, language):
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.M | re.S)


def anchors(page):
    """Slugs of the headings of a page; rows of the equation index have anchors of their own."""
    slugs = set()
    for heading in re.findall(r"^#+ (.*)$", prose(page), re.M):
        kept = re.sub(r"[^\w\s-]", "", heading.lower())
        slugs.add(re.sub(r"\s", "-", kept))
    if page.name == "equations.md":
        slugs |= {f"eq-{number}" for number in range(1, 81)}
    return slugs


@pytest.mark.parametrize("page", PAGES + NOTEBOOKS, ids=name)
def test_links_lead_somewhere(page):
    documented = {name for p in reference.PAGES for name, _ in reference.listed(p)}
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        path, _, anchor = target.partition("#")
        if path.startswith("https://"):
            continue
        if not path:
            known = {anchor, anchor.rpartition(".")[0]} & documented
            assert known or anchor in anchors(page), target
            continue
        if path == "gallery/index":  # made from the demos
            continue
        file = page.parent / path
        assert file.exists(), target
        assert not anchor or anchor in anchors(file), target


SHOWN = [
    (page, line.split("#")[0].strip())
    for page in [*PAGES, ROOT / "demos/README.rst"]
    for block in (
        blocks(page, "sh")
        if page.suffix == ".md"
        else [re.search(r"code-block:: sh\n\n((?:   .*\n)+)", page.read_text())[1]]
    )
    for line in block.splitlines()
    if line.split("#")[0].strip()
]


@pytest.mark.parametrize(("page", "line"), SHOWN, ids=[f"{p.stem}: {line}" for p, line in SHOWN])
def test_a_command_is_understood(page, line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    task = "\n".join(blocks(DOCS / "recipes/task.md", "python")[:1])
    (tmp_path / "visit.py").write_text(task)
    (tmp_path / "my_task.py").write_text(task)
    for folder in ("my_folder", "reach", "pushes", "others"):
        (tmp_path / folder).mkdir()
    # A folder of a campaign that began, and an array's job.
    (tmp_path / "pushes" / "campaign.json").write_text("{}")
    monkeypatch.setenv("SCRATCH", str(tmp_path))
    monkeypatch.setenv("SLURM_ARRAY_TASK_ID", "17")
    program, *words = os.path.expandvars(line.replace("'", "")).removesuffix(" &").split()
    if program == "make":
        assert all(f"\n{word}:" in (ROOT / "Makefile").read_text() for word in words)
    elif program == "pip":
        extras = re.findall(r"\[(\w+)\]", line)
        assert all(f"\n{extra} = [" in (ROOT / "pyproject.toml").read_text() for extra in extras)
    elif program == "python":
        file = words[2] if words[0] == "-m" and words[1] == "pytest" else words[0]
        assert words[:2] == ["-m", "pytest"] or (ROOT / file).exists()
    elif program == "dask":
        assert words[0] in ("scheduler", "worker")
    else:
        from tpsim.cli.parse import parse

        assert program == "tpsim", f"{line}: which program is this?"
        if words != ["demo"]:
            parse(words)
    sys.modules.pop("visit", None)


def test_the_readme_and_ideas_of_views_run():
    (code,) = re.findall(r"algebra of views.*?```python\n(.*?)```", PAGES[0].read_text(), re.S)
    names: dict = {}
    exec(code, names)
    assert len(names["views"]) == 5


def test_the_orders_of_the_page_on_time_are_those_of_tp_gmr():
    from tpsim import fit_tp_gmm, tp_gmr
    from tpsim.examples import u_demonstrations, u_frames

    taught = [d.with_time() for d in u_demonstrations(4)]
    frames = u_frames(np.random.default_rng(3), spread=2.0)
    names = {"tp_gmr": tp_gmr, "model": fit_tp_gmm(taught, 3), "frames": frames}
    names["times"] = taught[0].data[::20, :1]
    (code,) = blocks(DOCS / "time-pull.md", "python")
    paths = []
    for line in code.splitlines():
        exec(line, names)
        paths.append(names["path"].mean)
    assert len(paths) == 4
    assert min(np.abs(a - b).max() for a in paths for b in paths if a is not b) > 1e-6


def test_the_movement_of_the_page_on_manifolds_ends_in_the_second_dock():
    (code,) = blocks(DOCS / "manifolds.md", "python")
    names: dict = {}
    exec(code, names)
    path, place = names["path"], names["docks"](names["turned"], 0.3)[1]
    assert np.linalg.norm(path.mean[-1, :3] - place.b) < 0.02
    turned = names["rotation"].to_quaternion(place.A)
    assert np.degrees(names["S3"].distance(path.mean[-1, 3:], turned)) < 3


@pytest.mark.parametrize("page", [p for p in PAGES if blocks(p, "python")], ids=name)
def test_python_of_a_page_imports_what_there_is(page):
    """Its other lines are run by the tests that RUN_ELSEWHERE and this file name."""
    assert (ROOT / RUN_ELSEWHERE.get(page.stem, "README.md")).exists()
    for code in blocks(page, "python"):
        for node in ast.walk(ast.parse(code)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("tpsim"):
                module = import_module(node.module)
                assert all(hasattr(module, alias.name) for alias in node.names), node.module


@pytest.mark.parametrize("book", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_what_it_prints(book):
    cells = json.loads(book.read_text())["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 4
    assert all(not cell["outputs"] and cell["execution_count"] is None for cell in code)
    assert cells[0]["source"][0].startswith("# ")


@pytest.mark.parametrize("book", [book.stem for book in NOTEBOOKS])
def test_a_notebook_runs(book, monkeypatch):
    import matplotlib

    matplotlib.use("agg")
    monkeypatch.chdir(DOCS / "notebooks")
    names: dict = {}
    for cell in json.loads((DOCS / f"notebooks/{book}.ipynb").read_text())["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    figure = names["figure"]
    assert all(axis.has_data() for axis in figure.axes)
    names["plt"].close("all")


def test_the_navigation_takes_every_page():
    listed = set(re.findall(r"^([\w/-]+)$", (DOCS / "index.md").read_text(), re.M))
    listed |= set(guides.rest().split())
    for page in [*DOCS.glob("*.md"), *(DOCS / "recipes").glob("*.md")]:
        assert page.relative_to(DOCS).with_suffix("").as_posix() in listed | {"index"}
    for page in (DOCS / "api").glob("*.md"):
        assert page.stem in {*reference.PAGES, "mathematics", "laboratory"}


def test_a_page_that_no_list_names_is_taken(tmp_path, monkeypatch):
    (tmp_path / "index.md").write_text("```{toctree}\nstart\n```\n")
    for page in ("start", "campaigns"):
        (tmp_path / f"{page}.md").write_text("# A page\n")
    monkeypatch.setattr(guides, "DOCS", tmp_path)
    assert guides.rest() == "campaigns"


def test_every_demo_stands_in_one_section():
    demos = [name for _, names in gallery_pages.SECTIONS.values() for name in names]
    assert sorted(demos) == sorted(gallery.titles())


def test_a_demo_gets_its_title_and_keeps_its_words():
    said = "figure03: what two frames expect.\n\nLook for: the centre,\nand where it lies.\n"
    assert gallery_pages.titled("figure03", said) == (
        "figure03\n========\n\nWhat two frames expect.\n\n"
        "**Look for:** the centre,\nand where it lies.\n"
    )


def test_the_reference_has_every_public_name_once():
    listed = [name for page in reference.PAGES for name, _ in reference.listed(page)]
    rooms = [f"{room.prefix}.{name}" for room in reference.ROOMS for name in room.names]
    assert sorted(listed) == sorted(rooms)
    assert {"tpsim.gmr", "tpsim.lab.Robot", "tpsim.projection.joint"} <= set(listed)


def test_every_benchmark_has_words():
    page = benchmarks.page()
    recorded = json.loads(benchmarks.RECORDED.read_text())
    for area, figures in recorded["figures"].items():
        assert f"## {benchmarks.TITLES[area]}" in page
        for figure in figures:
            if figure in benchmarks.MEANING:
                assert f"| {benchmarks.MEANING[figure]} |" in page
            else:
                assert figure.endswith(tuple(benchmarks.TASK))
    assert recorded["machine"] in page and "processors" in recorded["machine"]


def test_the_citation_names_this_version_and_the_tutorial():
    citation = (ROOT / "CITATION.cff").read_text()
    (version,) = re.findall(r'^version = "(.*)"', (ROOT / "pyproject.toml").read_text(), re.M)
    assert f"\nversion: {version}\n" in citation
    page = (DOCS / "cite.md").read_text()
    (doi,) = re.findall(r"doi: (\S+)", citation)
    assert doi in page and "Intelligent Service Robotics" in citation
