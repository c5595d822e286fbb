"""MCAP with poses that Foxglove shows in 3-D, and every sample as JSON."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tpsim.border import border
from tpsim.data.signals import Item, Signals, signals_of
from tpsim.data.writers.foxglove import POSE_IN_FRAME, SAMPLES, pose_in_frame, stamp
from tpsim.data.writers.poses import poses_of
from tpsim.errors import ArgumentError
from tpsim.extras import extra
from tpsim.whole import whole_file

if TYPE_CHECKING:
    from mcap.writer import Writer


LAST = 4e9
"""Stamp [s] up to which seconds fit in 32 bits."""


@border
def write_mcap(path: str | Path, items: Sequence[Item] | Item, *, world: str = "world") -> Path:
    """Write demonstrations or trials to an MCAP file.

    Parameters
    ----------
    path : file name
        Usually ends with .mcap.
    items : demonstrations, or trials as arrays by name
        Number i has the topics ``/demonstration_i/samples``, with all signals, and one
        ``foxglove.PoseInFrame`` for every pose: of a demonstration its movement (the first three
        columns, or two, and a quaternion behind them where there is one) and its frames; of a trial
        ``<name>_position`` with ``<name>_quaternion``.
    world : str
        Name of the frame of reference.

    Raises
    ------
    ArgumentError
        Nothing to write, or items that hold different signals.
    RecordingError
        The package mcap is missing.
    """
    with extra("MCAP files"):
        from mcap.writer import Writer
    path = Path(path)
    signals = signals_of(items)
    with whole_file(path) as file:
        writer = Writer(file)
        writer.start(library="tpsim")
        schemas = {
            name: writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
            for name, schema in (
                ("foxglove.PoseInFrame", POSE_IN_FRAME),
                ("tpsim.Samples", SAMPLES),
            )
        }
        for i, one in enumerate(signals):
            _write(writer, schemas, f"/demonstration_{i}", one, world)
        writer.finish()
    return path


def _write(
    writer: "Writer", schemas: Mapping[str, int], prefix: str, signals: Signals, world: str
) -> None:
    if np.abs(signals.time).max() > LAST:
        raise ArgumentError(f"items have stamps beyond {LAST:.0e} s, which MCAP cannot count in ns")
    nanoseconds = np.round((signals.time - min(signals.time[0], 0.0)) * 1e9).astype(np.int64)
    topics: dict[str, tuple[str, Iterator[dict[str, Any]]]] = {
        "samples": ("tpsim.Samples", _samples(signals, nanoseconds))
    }
    for name, (position, quaternion) in poses_of(signals).items():
        poses = zip(nanoseconds, position, quaternion, strict=True)
        messages = (pose_in_frame(int(ns), world, p, q) for ns, p, q in poses)
        topics[name] = ("foxglove.PoseInFrame", messages)
    channels = {
        name: writer.register_channel(f"{prefix}/{name}", "json", schemas[kind])
        for name, (kind, _) in topics.items()
    }
    for ns in map(int, nanoseconds):
        for name, (_, waiting) in topics.items():
            content = json.dumps(next(waiting)).encode()
            writer.add_message(channels[name], log_time=ns, publish_time=ns, data=content)


def _samples(signals: Signals, nanoseconds: np.ndarray) -> Iterator[dict[str, Any]]:
    for row, ns in enumerate(nanoseconds):
        values = {name: column[row].tolist() for name, column in signals.columns.items()}
        yield {"timestamp": stamp(int(ns)), **values}
