"""The equation index is whole: every equation has a function with a test, or a reason."""

import re
from pathlib import Path

import equations
import gallery_pages
import pytest
import reference

ROOT = Path(__file__).parents[2]
ENTRIES = equations.index()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Eq. 4", {4}),
        ("as in Eq. (20).", {20}),
        ("Eqs (5-6)", {5, 6}),
        ("Eqs (5)-(6), found", {5, 6}),
        ("Eqs 12-19 and 75", {*range(12, 20), 75}),
        ("Eqs (9) and (50-52)", {9, 50, 51, 52}),
        ("Eqs 43, 44) of Section 7", {43, 44}),
        ("Eqs 5-6, 34, Section 6", {5, 6, 34}),
        ("Eqs (49-52), or (57-68) in subspaces", {*range(49, 53), *range(57, 69)}),
        ("Eqs (1-2) at 10 m", {1, 2}),
        ("Eq. 33, 10 s long", {33}),
        ("Section 5.1, Fig. 7, Table 3", set()),
    ],
)
def test_numbers_are_read_as_people_write_them(text, expected):
    assert equations.numbers(text) == expected


def test_sections_hold_every_equation_once():
    spans = [number for a, b in equations.SECTIONS.values() for number in range(a, b + 1)]
    assert spans == list(range(1, 81)) == [entry.number for entry in ENTRIES]


def test_every_equation_has_a_function_with_a_test_or_a_reason():
    for entry in ENTRIES:
        reason = equations.NOT_IN_CODE.get(entry.number, "")
        assert bool(entry.functions) != bool(reason), f"Eq. ({entry.number})"
        assert len(reason) > 20 or entry.tests, f"no test calls what Eq. ({entry.number}) names"


def test_known_equations_lead_to_their_functions():
    named = {entry.number: {f.public for f in entry.functions} for entry in ENTRIES}
    assert named[3] == {"tpsim.gaussian_product"}
    assert "tpsim.TPGMM.adapt" in named[5] & named[6]
    assert named[19] >= {"tpsim.match_moments", "tpsim.gmr"}
    assert "tpsim.integrator" in named[33]
    assert "tpsim.lqt_batch" in named[37]
    rows = ("joint", "absolute", "relative")
    rows += ("nullspace_joint", "nullspace_absolute", "nullspace_relative")
    for number, row in zip(range(39, 45), rows, strict=True):
        assert f"tpsim.projection.{row}" in named[number]
    assert "tpsim.fit_tp_gmm" in named[52] and "tpsim.MPPCA" in named[64]
    assert "tpsim.fit_pgmm" in named[78]


def test_what_the_index_names_exists():
    documented = {name for page in reference.PAGES for name, _ in reference.listed(page)}
    for entry in ENTRIES:
        for function in entry.functions:
            assert function.public, f"{function.module}.{function.name} is not public"
            # A method is documented with its class.
            assert documented & {function.public, function.public.rpartition(".")[0]}
        for test in entry.tests:
            file, name = test.split("::")
            assert f"def {name}(" in (ROOT / file).read_text()
        for demo in entry.demos:
            assert gallery_pages.page(demo)


def test_a_definition_that_names_no_equation_is_missed():
    """The index follows the code: without the number in its docstring a function is not in it."""
    source = (ROOT / "tpsim/control/system.py").read_text()
    assert "Eq. 33" in source
    assert 33 not in equations.numbers(re.sub(r"Eq\. 33", "the system", source))


def test_the_page_has_a_row_for_every_equation():
    page = equations.page()
    assert [int(n) for n in re.findall(r"#eq-(\d+)", page)] == list(range(1, 81))
    assert page.count("*not in the code:*") == len(equations.NOT_IN_CODE)
