"""Every demo runs, and the numbers that it shows are finite."""

import math
import numbers
import runpy

import numpy as np
import pytest

from tpsim.experiment import gallery
from tpsim.paths import DEMOS

SCRIPTS = sorted(DEMOS.glob("demo_*.py"))
LINES = 65  # one scroll


def numbers_in(value):
    """All numbers in a nest of dictionaries, lists and arrays."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        for item in value:
            yield from numbers_in(item)
    elif isinstance(value, numbers.Number):
        yield value


def test_there_are_demos():
    assert SCRIPTS


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_demo_returns_finite_numbers(script):
    figures = runpy.run_path(str(script))["main"]()
    assert isinstance(figures, dict)
    found = list(numbers_in(figures))
    assert found
    assert all(math.isfinite(number) for number in found)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_demo_is_short_and_named_like_its_row_of_table_2(script):
    assert len(script.read_text().splitlines()) <= LINES
    title = gallery.titles()[script.stem]
    assert title.startswith(f"{script.stem}: ")
