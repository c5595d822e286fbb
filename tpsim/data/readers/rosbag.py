"""ROS 1 bags (a file) and ROS 2 bags (a folder), read by the package rosbags."""

from pathlib import Path

from tpsim.data.foreign import opened
from tpsim.data.readers.messages import Messages
from tpsim.data.recording import Recording
from tpsim.errors import RecordingError
from tpsim.extras import extra


def recordings(path: Path) -> list[Recording]:
    """Read a bag: joint states, poses, transforms and all other numbers, topic by topic."""
    with extra("ROS bags"):
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    messages = Messages()
    with opened(path, "ROS bag"):
        # Bags of ROS 2 before Iron do not hold the definitions of their messages.
        types = get_typestore(Stores.ROS2_HUMBLE)
        with AnyReader([path], default_typestore=types) as reader:
            for connection, stamp, raw in reader.messages():
                message = reader.deserialize(raw, connection.msgtype)
                messages.add(connection.topic, connection.msgtype, stamp, message)
        series = messages.series()
    if not series:
        raise RecordingError(f"{path}: holds no messages with numbers")
    return [Recording(str(path), series, path.stem, "rosbag", clock=True)]
