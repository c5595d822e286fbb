"""Values as JSON with their arrays beside it, and back: every kind and type is checked."""

import types
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, Union, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from tpsim.errors import ArgumentError, RecordingError, one_line

Kinds = Mapping[str, type]
"""Dataclasses that a file may hold, by name."""


def taken_apart(value: object, arrays: dict[str, np.ndarray]) -> object:
    """JSON values of a value made of dataclasses, mappings, tuples, arrays and plain values.

    Parameters
    ----------
    value : object
    arrays : dict
        Receives the arrays, by the names that the JSON values use.

    Raises
    ------
    ArgumentError
        If something in it is none of these.
    """
    if isinstance(value, np.ndarray):
        name = f"array-{len(arrays)}"
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value) and not isinstance(value, type):
        parts = {f.name: taken_apart(getattr(value, f.name), arrays) for f in fields(value)}
        return {"kind": type(value).__name__} | parts
    if isinstance(value, Mapping):
        return {"items": [[str(key), taken_apart(item, arrays)] for key, item in value.items()]}
    if isinstance(value, tuple | list):
        return [taken_apart(item, arrays) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise ArgumentError(f"a policy cannot hold {value!r:.60} of type {type(value).__name__}")


class Reader:
    """Puts values together again.

    Parameters
    ----------
    kinds : mapping of str to type
        Dataclasses that may occur; no other class is ever made.
    arrays : mapping of str to ndarray
    where : object
        Name of the file, for messages.
    """

    def __init__(self, kinds: Kinds, arrays: Mapping[str, np.ndarray], where: object):
        self._kinds, self._arrays, self._where = kinds, arrays, where

    def read(self, found: object, hint: Any, path: str = "$") -> Any:
        """Value of a type.

        Raises
        ------
        RecordingError
            Names file and field: another type, a missing or unknown field, an unknown kind.
        """
        if isinstance(found, dict):
            value = self._of_dict(found, hint, path)
        elif isinstance(found, list):
            value = self._of_list(found, hint, path)
        else:
            value = self._plain(found, hint, path)
        return value

    def _of_dict(self, found: dict[str, Any], hint: Any, path: str) -> object:
        if "array" in found:
            array = self._arrays.get(str(found["array"]))
            if array is None or not _allows(hint, np.ndarray):
                raise self._wrong(f"the array {found['array']!r} is missing or out of place", path)
            if array.dtype.kind != "f" or np.isnan(array).any():
                raise self._wrong(f"the array {found['array']!r} holds what is no number", path)
            return array
        if "items" in found:
            pairs, inner = found["items"], _item(hint, Mapping)
            if inner is None or not isinstance(pairs, list) or not all(map(_is_pair, pairs)):
                raise self._wrong("what is mapped here is out of place", path)
            return {k: self.read(v, inner, f"{path}.{k}") for k, v in pairs}
        name = str(found.get("kind"))
        if name not in self._kinds:
            raise self._wrong(
                f"unknown kind {name!r}; pass your own views as Policy.load(folder, views=[...])",
                path,
            )
        kind = self._kinds[name]
        if not _allows(hint, kind):
            raise self._wrong(f"{name} is out of place", path)
        return self._made(kind, {k: v for k, v in found.items() if k != "kind"}, path)

    def _made(self, kind: type, found: dict[str, Any], path: str) -> object:
        hints = get_type_hints(kind)
        names = [f.name for f in fields(kind)]
        if set(names) != set(found):
            odd = sorted(set(names) ^ set(found))
            raise self._wrong(f"{kind.__name__} has missing or unknown fields {odd}", path)
        values = {n: self.read(found[n], hints[n], f"{path}.{n}") for n in names}
        try:
            return kind(**values)
        except (ArgumentError, TypeError, ValueError) as error:
            raise self._wrong(str(error), path) from None

    def _of_list(self, found: list[Any], hint: Any, path: str) -> object:
        inner = _item(hint, tuple)
        if inner is None:
            raise self._wrong("a list is out of place", path)
        return tuple(self.read(item, inner, f"{path}[{i}]") for i, item in enumerate(found))

    def _plain(self, found: object, hint: Any, path: str) -> object:
        for arm in _arms(hint):
            if isinstance(arm, type) and (is_dataclass(arm) or arm not in _PLAIN):
                continue
            try:
                return msgspec.convert(found, arm)
            except msgspec.ValidationError:
                continue
        raise self._wrong(f"{found!r:.40} is out of place", path)

    def _wrong(self, what: str, path: str) -> RecordingError:
        line = one_line(ValueError(what), 300)
        return RecordingError(f"{self._where} is damaged: {line} - at `{path:.200}`")


_PLAIN = (bool, int, float, str, type(None))


def _arms(hint: Any) -> tuple[Any, ...]:
    """The types that a hint allows."""
    union = get_origin(hint) in (Union, types.UnionType)
    return get_args(hint) if union else (hint,)


def _allows(hint: Any, kind: type) -> bool:
    return any(isinstance(arm, type) and issubclass(kind, arm) for arm in _arms(hint))


def _item(hint: Any, container: type) -> Any:
    """X of ``tuple[X, ...]`` or ``Mapping[str, X]``; None where a type is no such container."""
    for arm in _arms(hint):
        origin = get_origin(arm)
        if isinstance(origin, type) and issubclass(origin, container):
            return [a for a in get_args(arm) if a is not Ellipsis][-1]
    return None


def _is_pair(found: object) -> bool:
    return isinstance(found, list) and len(found) == 2 and isinstance(found[0], str)
