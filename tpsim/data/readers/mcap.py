"""MCAP files with messages of ROS 2, or in JSON as Foxglove and tpsim write them."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from tpsim.data.foreign import check_size, opened
from tpsim.data.readers.messages import Messages
from tpsim.data.recording import Recording
from tpsim.errors import RecordingError
from tpsim.extras import extra
from tpsim.npz import BYTES

Decoder = Callable[[bytes], Any]

_OURS = re.compile(r"/demonstration_(\d+)/")


def recordings(path: Path) -> list[Recording]:
    """Read joint states, poses, transforms and all other numbers, topic by topic.

    A file that tpsim wrote gives one recording for every demonstration in it.
    """
    with extra("MCAP files"):
        from mcap.decoder import DecoderFactory
        from mcap.reader import make_reader
        from mcap.records import Chunk, Schema
        from mcap.stream_reader import StreamReader
        from mcap_ros2.decoder import DecoderFactory as Ros2

    class Json(DecoderFactory):
        def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decoder | None:
            return _namespace if message_encoding == "json" else None

    class Rest(DecoderFactory):
        def decoder_for(self, message_encoding: str, schema: Schema | None) -> Decoder | None:
            passed_over.add(message_encoding)
            return lambda raw: SimpleNamespace()

    found: dict[int, Messages] = {}
    passed_over: set[str] = set()
    with opened(path, "MCAP file"), path.open("rb") as file:
        for record in StreamReader(file, emit_chunks=True, record_size_limit=BYTES).records:
            if isinstance(record, Chunk):
                check_size(path, record.uncompressed_size // 8)
        file.seek(0)
        reader = make_reader(file, validate_crcs=True, decoder_factories=[Json(), Ros2(), Rest()])
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            ours = _OURS.match(channel.topic)
            messages = found.setdefault(int(ours[1]) if ours else -1, Messages())
            messages.add(channel.topic, schema.name if schema else "", message.log_time, decoded)
        series = {number: messages.series() for number, messages in sorted(found.items())}
    if not any(series.values()):
        raise RecordingError(
            f"{path}: holds no messages with numbers in JSON or ROS 2"
            + (f", only in {', '.join(sorted(passed_over))}" if passed_over else "")
        )
    return [
        Recording(
            str(path),
            columns,
            path.stem if number < 0 else f"demonstration_{number}",
            "mcap",
            clock=True,
        )
        for number, columns in series.items()
        if columns
    ]


def _namespace(raw: bytes) -> Any:
    return json.loads(raw, object_hook=lambda members: SimpleNamespace(**members))
