"""Hostile calls: arguments of everything public, alone and in pairs, spoiled at random."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from hostile import Hostile, corruptions
from recipe import Made, Recipe
from verdict import Verdict, judge


class Call(NamedTuple):
    """A good call of which one or two arguments are spoiled.

    Parameters
    ----------
    recipe : Recipe
    spoiled : dict of str to Hostile
    """

    recipe: Recipe
    spoiled: dict[str, Hostile]

    def __str__(self) -> str:
        what = ", ".join(f"{name}={hostile.label}" for name, hostile in self.spoiled.items())
        return f"{self.recipe.name}({what})"

    def verdict(self) -> Verdict:
        """Make the call, and judge."""
        recipe = self.recipe
        arguments = recipe.fresh()
        with np.errstate(all="ignore"):
            arguments |= {name: hostile.make() for name, hostile in self.spoiled.items()}
        nonsense = {name: _nonsense(recipe, name, h) for name, h in self.spoiled.items()}
        kind, words = judge(
            recipe.call, arguments, nonsense, recipe.infinite, recipe.keeps, recipe.words
        )
        long = kind == "slow" and words.startswith("takes") and set(recipe.patient) & set(nonsense)
        return Verdict("fine" if long else kind, words)


def _nonsense(recipe: Recipe, name: str, hostile: Hostile) -> bool:
    taken = recipe.takes.get(name, set())
    return hostile.nonsense and name not in recipe.free and not taken & {hostile.label, "*"}


def drawn(recipes: list[Recipe], count: int, seed: int) -> Iterator[Call]:
    """Calls drawn at random: functions evenly, then one or two of their arguments."""
    rng = np.random.default_rng(seed)
    able = [recipe for recipe in recipes if recipe.arguments]
    known: dict[tuple[int, str], list[Hostile]] = {}
    for _ in range(count):
        which = int(rng.integers(len(able)))
        recipe, names = able[which], list(able[which].arguments)
        chosen = rng.permutation(names)[: 1 + int(rng.random() < 0.5)]
        spoiled = {}
        for name in map(str, chosen):
            if (which, name) not in known:
                good = recipe.arguments[name]
                known[which, name] = corruptions(good.make() if isinstance(good, Made) else good)
            ways = known[which, name]
            spoiled[name] = ways[int(rng.integers(len(ways)))]
        yield Call(recipe, spoiled)
