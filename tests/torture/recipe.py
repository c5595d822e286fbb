"""A good call of everything public: what hostile calls are made of."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np


class Made:
    """An argument that is made anew for every call, since calls change it.

    Parameters
    ----------
    make : callable
    """

    def __init__(self, make: Callable[[], object]):
        self.make = make


@dataclass(frozen=True)
class Recipe:
    """A good call.

    Parameters
    ----------
    name : str
        As :func:`api.public_calls` has it.
    call : callable
        A function, a class, or a bound method.
    arguments : dict
        Good ones, by name. What begins with a star is given by position.
    takes : dict of str to set of str
        Labels of nonsense that an argument documents to take.
    infinite : bool
        Whether answers may be infinite: logarithms of zero.
    keeps : tuple of str
        Arguments that the answer documents to hold as they are.
    free : tuple of str
        Arguments that may be anything.
    words : tuple of str
        Other names of what is given, by which a message may call it.
    patient : tuple of str
        Arguments that may ask for more work than a call has time for, such as a duration.
    """

    name: str
    call: Callable[..., object]
    arguments: dict[str, object]
    takes: dict[str, set[str]] = field(default_factory=dict)
    infinite: bool = False
    keeps: tuple[str, ...] = ()
    free: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    patient: tuple[str, ...] = ()

    def fresh(self) -> dict[str, object]:
        """Good arguments, whose arrays nobody else holds."""
        return {name: copied(value) for name, value in self.arguments.items()}


def copied(value: object) -> object:
    """Own arrays, lists and dictionaries; values of tpsim as they are."""
    if isinstance(value, Made):
        return value.make()
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, dict):
        return {key: copied(part) for key, part in value.items()}
    if type(value) in (list, tuple):
        return type(value)(copied(part) for part in value)
    return value


class Book(dict[str, list[Recipe]]):
    """Recipes by name; several of one name are several ways to call it."""

    def add(
        self,
        name: str,
        call: Callable[..., object],
        /,
        takes: dict[str, set[str]] | None = None,
        infinite: bool = False,
        keeps: tuple[str, ...] = (),
        free: tuple[str, ...] = (),
        words: tuple[str, ...] = (),
        patient: tuple[str, ...] = (),
        **arguments: object,
    ) -> None:
        """Add a good call."""
        recipe = Recipe(name, call, arguments, takes or {}, infinite, keeps, free, words, patient)
        self.setdefault(name, []).append(recipe)
