"""All methods on the same demonstrations and the same situations; a failure is a row."""

import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import RecordingError, one_line
from tpsim.npz import read_members, write_members
from tpsim.section8.families import Situation
from tpsim.section8.measures import FIGURES, measure
from tpsim.section8.method import Method, Path, Retrieve

KIND = "comparison of methods"

Measured = Callable[[Path, Any], Mapping[str, float]]
"""Figures of a movement that was retrieved in a situation."""

_KINDS = {
    "methods": "U",
    "figures": "f",
    "train_ms": "f",
    "adapt_us": "f",
    "parameters": "f",
    "reasons": "U",
}
"""Kinds of the arrays of a file."""


@dataclass(frozen=True, eq=False)
class Trial:
    """What all methods did after the same demonstrations.

    Parameters
    ----------
    methods : (m,) names
    figures : (m, n, f)
        Figures in n situations; NaN where a method failed or has no such.
    train_ms, adapt_us : (m,)
        Processor time of learning, and of one retrieval (median).
    parameters : (m,)
        Numbers that a method keeps; NaN where it does not say.
    reasons : (m,)
        Why a method failed; empty where it did not.
    """

    methods: tuple[str, ...]
    figures: NDArray
    train_ms: NDArray
    adapt_us: NDArray
    parameters: NDArray
    reasons: tuple[str, ...]

    @classmethod
    def failed(
        cls, methods: Collection[str], situations: int, figures: Collection[str], reason: str
    ) -> "Trial":
        """What stands where nothing could be done: no figures, and the reason."""
        nothing = np.full(len(methods), np.nan)
        measured = np.full((len(methods), situations, len(figures)), np.nan)
        reasons = (reason,) * len(methods)
        return cls(tuple(methods), measured, nothing, nothing, nothing, reasons)

    def save(self, path: FilePath, key: str) -> None:
        """Write to an archive that remembers what it is the result of."""
        arrays = {
            "key": np.array(key),
            "methods": np.array(self.methods),
            "figures": self.figures,
            "train_ms": self.train_ms,
            "adapt_us": self.adapt_us,
            "parameters": self.parameters,
            "reasons": np.array(self.reasons),
        }
        write_members(path, {"kind": np.array(KIND), **arrays})

    @classmethod
    def load(cls, path: FilePath, key: str) -> "Trial":
        """Read what :meth:`save` wrote.

        Raises
        ------
        RecordingError
            The file is damaged, or the result of something else.
        """
        arrays = read_members(path)
        found = {name: arrays.get(name, np.array(None)) for name in ("kind", "key", *_KINDS)}
        m = found["methods"].size
        shapes = {name: (m,) for name in _KINDS}
        shapes["figures"] = (m, *found["figures"].shape[1:3])
        wrong = [
            name
            for name, kind in _KINDS.items()
            if found[name].dtype.kind != kind or found[name].shape != shapes[name]
        ]
        if (str(found["kind"]), str(found["key"])) != (KIND, key) or wrong:
            raise RecordingError(
                f"{path} is no result of this comparison ({', '.join(wrong) or 'another key'}); "
                "delete it and run again"
            )
        return cls(
            tuple(map(str, found["methods"])),
            found["figures"],
            found["train_ms"],
            found["adapt_us"],
            found["parameters"],
            tuple(map(str, found["reasons"])),
        )


def of_path(path: Path, situation: Situation) -> dict[str, float]:
    """Figures of :data:`FIGURES`: of the retrieved movement itself."""
    return measure(path, situation.truth, situation.drawn)


def perform(
    methods: Mapping[str, Method],
    demonstrations: Sequence[Demonstration],
    situations: Sequence[Situation],
    measured: Measured = of_path,
    figures: Sequence[str] = tuple(FIGURES),
) -> Trial:
    """Learn with every method and retrieve in every situation.

    Parameters
    ----------
    methods
        By name.
    demonstrations
        On one clock.
    situations
        With the teacher's own movement, at the same times.
    measured
        What is measured of a movement in a situation.
    figures
        The names that it gives.
    """
    taught = list(demonstrations)
    rows = [_row(m, taught, situations, measured, figures) for m in methods.values()]
    return Trial(
        tuple(methods),
        np.array([row.figures for row in rows]),
        np.array([row.train_ms for row in rows]),
        np.array([row.adapt_us for row in rows]),
        np.array([row.parameters for row in rows]),
        tuple(row.reason for row in rows),
    )


@dataclass(frozen=True, eq=False)
class _Row:
    figures: NDArray
    train_ms: float = np.nan
    adapt_us: float = np.nan
    parameters: float = np.nan
    reason: str = ""


def learn(method: Method, demonstrations: list[Demonstration]) -> tuple[Retrieve | None, str]:
    """Learned retrieval, or None and the reason why there is none."""
    try:
        retrieve = method(demonstrations)
    except Exception as error:  # a method is anybody's code: its failure is a result
        return None, _reason(error)
    return (retrieve, "") if callable(retrieve) else (None, "learned nothing that can be called")


def retrieved(retrieve: Retrieve, situation: Situation) -> tuple[Path | None, str]:
    """Movement in a situation, or None and the reason why there is none."""
    try:
        return retrieve(situation.frames), ""
    except Exception as error:  # as above
        return None, _reason(error)


def _row(
    method: Method,
    demonstrations: list[Demonstration],
    situations: Sequence[Situation],
    measured: Measured,
    names: Sequence[str],
) -> _Row:
    figures = np.full((len(situations), len(names)), np.nan)
    start = time.process_time()
    retrieve, reason = learn(method, demonstrations)
    train_ms = 1e3 * (time.process_time() - start)
    if retrieve is None:
        return _Row(figures, reason=reason)
    took, reasons = [], []
    for n, situation in enumerate(situations):
        start = time.process_time()
        path, reason = retrieved(retrieve, situation)
        took.append(1e6 * (time.process_time() - start))
        if path is not None:
            try:
                found = measured(path, situation)
                figures[n] = [found[name] for name in names]
            except Exception as error:  # what it returned may be no movement at all
                reason = _reason(error)
        reasons.append(reason)
    failed = [reason for reason in reasons if reason]
    count = f" ({len(failed)} of {len(situations)} situations)" if failed else ""
    return _Row(
        figures,
        train_ms,
        float(np.median(took)),
        float(getattr(retrieve, "parameters", np.nan)),
        failed[0] + count if failed else "",
    )


def _reason(error: Exception) -> str:
    return one_line(error, 200)
