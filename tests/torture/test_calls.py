"""Everything public, called with nonsense: a fine answer, or one clear line, and nothing else."""

import os
import re
import resource
from collections import Counter

import api
import numpy as np
import pytest
from calls import drawn
from recipes import laboratory, mathematics, recordings
from verdict import GOOD, judge

from tpsim import Demonstration, Frame, fit_gmm, fit_tp_gmm, fit_trajectory_distribution, gmr

ROOMS = {"mathematics": mathematics, "laboratory": laboratory, "recordings": recordings}
MEMORY = 8 * 2**30
"""Address space [bytes] in which all calls must find room."""

SAMPLE, ALL = 500, 7000
"""Calls drawn, of which a third is for each room."""

FIRST = int(os.environ.get("TPSIM_SEED", "64000"))
"""Seed of the first of the thousands; others draw other calls."""


@pytest.fixture(scope="module")
def books():
    return {name: room.book() for name, room in ROOMS.items()}


@pytest.fixture(autouse=True)
def small_world(tmp_path, monkeypatch):
    """A folder of its own, and not all memory of the machine."""
    monkeypatch.chdir(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_AS, before)


def test_everything_public_has_a_good_call(books):
    """A new public name needs a recipe, which is then spoiled in all ways."""
    written = {name for book in books.values() for name in book}
    public = set(api.public_calls())
    assert public - written == set(), "give these a recipe in tests/torture/recipes"
    assert written - public == set()


@pytest.mark.parametrize("room", ROOMS)
def test_the_good_calls_are_good(books, room):
    """Finite answers, inputs as they were, nothing shared, no warnings, in time."""
    for recipes in books[room].values():
        for recipe in recipes:
            kind, words = judge(
                recipe.call, recipe.fresh(), {}, recipe.infinite, recipe.keeps, recipe.words
            )
            assert kind == "fine", f"{recipe.name}: {kind}, {words}"


def tortured(calls):
    """How the calls ended, and those that ended badly."""
    counts, bad = Counter(), []
    for call in calls:
        kind, words = call.verdict()
        counts[kind] += 1
        if kind not in GOOD:
            bad.append(f"{call}: {kind}, {words}")
    return counts, bad


@pytest.mark.parametrize("room", ROOMS)
def test_hostile_calls_end_well(books, room):
    recipes = [recipe for found in books[room].values() for recipe in found]
    counts, bad = tortured(drawn(recipes, SAMPLE // 3, seed=11))
    assert not bad, "\n".join([str(dict(counts)), *bad[:20]])


@pytest.mark.torture
@pytest.mark.parametrize("room", ROOMS)
@pytest.mark.parametrize("seed", range(3))
def test_thousands_of_hostile_calls_end_well(books, room, seed, capfd):
    recipes = [recipe for found in books[room].values() for recipe in found]
    counts, bad = tortured(drawn(recipes, ALL // 3, FIRST + seed))
    with capfd.disabled():
        print(f"\n{room}, seed {FIRST + seed}: {dict(counts)}")
    assert not bad, "\n".join(bad[:50])


@pytest.mark.parametrize("scale", [1e-90, 1e-40, 1e40, 1e70])
def test_the_unit_of_the_data_is_no_matter_at_any_scale(scale):
    """The same models, scaled: far beyond what anybody measures in."""
    rng, t = np.random.default_rng(2), np.linspace(0, 1, 40)
    paths = [np.column_stack([t + 0.1 * k, np.sin(4 * t)]) + 0.02 * rng.normal(size=(40, 2))
             for k in range(3)]  # fmt: skip
    frames = [Frame(np.eye(2), rng.normal(size=2)) for _ in paths]
    plain = [Demonstration(t, x, f) for x, f in zip(paths, frames, strict=True)]
    scaled = [
        Demonstration(t, scale * x, Frame(f.A, scale * f.b))
        for x, f in zip(paths, frames, strict=True)
    ]
    one, other = (
        fit_gmm(paths, 2, start="time"),
        fit_gmm([scale * x for x in paths], 2, start="time"),
    )
    np.testing.assert_allclose(other.gaussians.mean / scale, one.gaussians.mean, rtol=1e-6)
    assert other.gaussians.covariance.shape == one.gaussians.covariance.shape
    np.testing.assert_allclose(other.priors, one.priors, rtol=1e-6)
    models = [
        fit_tp_gmm([d.with_time() for d in some], 2, start="time") for some in (plain, scaled)
    ]
    found = [
        gmr(model.adapt([Frame(np.eye(2), s * np.array([0.3, 0.1])).with_input()]), [0.2, 0.8]).mean
        for model, s in zip(models, (1.0, scale), strict=True)
    ]
    np.testing.assert_allclose(found[1] / scale, found[0], rtol=1e-5)
    kept = [
        fit_trajectory_distribution(np.stack([d.data for d in some]), 2) for some in (plain, scaled)
    ]
    np.testing.assert_allclose(kept[1].mean / scale, kept[0].mean, rtol=1e-6)


def test_a_message_names_the_argument_on_one_line(monkeypatch):
    """The judge itself: what is nameless, on two lines, or foreign is not well."""

    def refuses(words):
        from tpsim.errors import ArgumentError

        def call(ridge):
            raise ArgumentError(words)

        return judge(call, {"ridge": -1}, {"ridge": False}).kind

    assert refuses("ridge is -1; give a finite number, not negative") == "refused"
    assert refuses("give another number") == "nameless"
    assert refuses("ridge is bad\nvery bad") == "unreadable"
    assert judge(lambda a: a, {"a": np.ones(2)}, {}).kind == "aliased"
    assert judge(lambda a: a.sort() or 1.0, {"a": np.array([2.0, 1.0])}, {}).kind == "mutated"
    assert judge(lambda a: a + np.nan, {"a": np.ones(2)}, {}).kind == "not finite"
    assert judge(lambda a: float(a), {"a": "x"}, {"a": False}).kind == "foreign"
    assert judge(lambda a: 1.0, {"a": np.nan}, {"a": True}).kind == "nonsense"
    monkeypatch.setattr("verdict.LIMIT", 0.1)
    assert re.match("takes|hangs", judge(lambda: [0 for _ in iter(int, 1)], {}, {}).words)
