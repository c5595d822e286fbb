"""Archives (.npz) of values and models: written whole or not at all, read without pickles.

A value is stored as the arrays of its fields under dotted names, with the name of its class and
the version of this layout. :func:`load` reads any of them back as the class that it was.
"""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import ClassVar, Self

import numpy as np

from tpsim import checks
from tpsim.errors import ArgumentError, RecordingError, one_line
from tpsim.npz import read_members, write_members

SCHEMA = 1

Arrays = dict[str, np.ndarray]


class Part:
    """Base of frozen dataclasses that an archive can hold, alone or inside of others."""

    kinds: ClassVar[dict[str, type["Part"]]] = {}

    def __init_subclass__(cls, **options: object) -> None:
        """Make the class known to archives by its name."""
        super().__init_subclass__(**options)
        Part.kinds[cls.__name__] = cls


class Stored(Part):
    """Base of the values and models that have ``save`` and ``load``."""

    def save(self, path: str | Path) -> Path:
        """Write to a new .npz archive, whole or not at all, without pickles.

        RecordingError where there is such a file: nothing is overwritten.
        """
        return save_arrays(path, _packed("", self))

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read what :meth:`save` wrote; RecordingError where the file is something else."""
        found = load(path)
        if not isinstance(found, cls):
            raise RecordingError(
                f"{path} is a {type(found).__name__}; a {cls.__name__} was asked for "
                "(tpsim.load reads either)"
            )
        return found


def load(path: str | Path) -> Stored:
    """Read any value or model that its ``save`` wrote, as the class that it was.

    Raises
    ------
    RecordingError
        The file is missing, truncated, of another kind, or of a newer version of tpsim.
    """
    arrays = load_arrays(path)
    schema = arrays.get("schema")
    if schema is None or schema.ndim or schema.dtype.kind not in "iu" or "kind" not in arrays:
        raise RecordingError(f"{path} holds no value or model of tpsim; use a file of save()")
    if int(schema) > SCHEMA:
        raise RecordingError(
            f"{path} has schema {int(schema)}, this version reads up to {SCHEMA}; update tpsim"
        )
    try:
        found = _unpacked("", arrays)
    # Constructors are given whatever stands there, and raise about anything.
    except Exception as error:
        raise RecordingError(f"{path} is damaged ({one_line(error, 300)})") from error
    if not isinstance(found, Stored):
        raise RecordingError(f"{path} holds a {type(found).__name__}, which does not stand alone")
    return found


def save_arrays(path: str | Path, arrays: Mapping[str, np.ndarray]) -> Path:
    """Write named arrays with the version of this layout."""
    return write_members(checks.path("path", path), {"schema": np.array(SCHEMA), **arrays})


def load_arrays(path: str | Path) -> Arrays:
    """Read the arrays of an archive; RecordingError where it is missing or damaged."""
    return read_members(checks.path("path", path))


def _packed(prefix: str, value: object) -> Arrays:
    """Arrays of a value whose fields are named ``prefix`` + field."""
    if isinstance(value, Part) and is_dataclass(value):
        packed = {f"{prefix}kind": np.array(type(value).__name__)}
        for field in fields(value):
            packed |= _field(f"{prefix}{field.name}", getattr(value, field.name))
        return packed
    if isinstance(value, tuple | list):
        packed = {f"{prefix}kind": np.array("tuple"), f"{prefix}length": np.array(len(value))}
        for i, entry in enumerate(value):
            packed |= _field(f"{prefix}{i}", entry)
        return packed
    raise ArgumentError(f"{prefix.rstrip('.')} is a {type(value).__name__}, which is not stored")


def _field(name: str, value: object) -> Arrays:
    if value is None:
        return {f"{name}.kind": np.array("None")}
    if isinstance(value, np.ndarray | np.generic | str | int | float):
        return {name: np.asarray(value)}
    return _packed(f"{name}.", value)


def _unpacked(prefix: str, arrays: Arrays) -> object:
    kind = str(arrays[f"{prefix}kind"])
    if kind == "None":
        return None
    if kind == "tuple":
        length = int(arrays[f"{prefix}length"])
        return tuple(_read(f"{prefix}{i}", arrays) for i in range(length))
    if kind not in Part.kinds:
        raise KeyError(f"kind {kind!r} is not known")
    cls = Part.kinds[kind]
    assert is_dataclass(cls)
    return cls(**{field.name: _read(f"{prefix}{field.name}", arrays) for field in fields(cls)})


def _read(name: str, arrays: Arrays) -> object:
    if name not in arrays:
        return _unpacked(f"{name}.", arrays)
    array = arrays[name]
    return array.item() if array.ndim == 0 else array
