"""Results for people and for programs: a dictionary as aligned text, or as plain JSON values."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Return ``value`` as JSON values: arrays as lists, paths as text, NaN and infinity as null."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, str | bool | int):
        return value
    return str(value) if not isinstance(value, Path) else value.as_posix()


def summary(result: Mapping[str, Any]) -> str:
    """Return ``result`` as text: one aligned line per value, one indented block per group."""
    return "\n".join(_block(plain(result), "")).strip("\n")


def _block(group: Mapping[str, Any], indent: str) -> list[str]:
    lines = []
    leaves = (key for key, value in group.items() if not _is_nested(value))
    width = max((len(_words(key)) for key in leaves), default=0)
    for key, value in group.items():
        if _is_nested(value):
            lines += ["", f"{indent}{_words(key)}", *_nested(value, indent + "  ")]
        else:
            lines.append(f"{indent}{_words(key):<{width}}  {_text(value)}")
    return lines


def _nested(value: Any, indent: str) -> list[str]:
    if isinstance(value, Mapping):
        return _block(value, indent)
    if all(isinstance(item, Mapping) for item in value):
        return _table(value, indent)
    return [f"{indent}- {_text(item)}" for item in value]


def _table(rows: Sequence[Mapping[str, Any]], indent: str) -> list[str]:
    """Rows of equal keys as columns under one heading."""
    heads = list(dict.fromkeys(key for row in rows for key in row))
    cells = [[_words(head) for head in heads]]
    cells += [[_text(row.get(head)) for head in heads] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return [
        (indent + "  ".join(f"{cell:<{w}}" for cell, w in zip(line, widths, strict=True))).rstrip()
        for line in cells
    ]


def _is_nested(value: Any) -> bool:
    if isinstance(value, Mapping):
        return bool(value)
    return isinstance(value, list) and any(isinstance(item, dict | str) for item in value)


def _words(key: str) -> str:
    return str(key).replace("_", " ")


def _text(value: Any) -> str:
    if value is None:
        return "-"
    if value == [] or value == {}:
        return "nothing"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list):
        return " ".join(map(_text, value))
    if isinstance(value, Mapping):
        return ", ".join(f"{_words(key)} {_text(item)}" for key, item in value.items())
    return str(value)
