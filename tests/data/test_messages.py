"""Topics on their own clocks: joints of several publishers, trees of transforms."""

from types import SimpleNamespace as Message

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tpsim import TpsimError
from tpsim.data import Columns, Recording
from tpsim.data.build import demonstrations_of
from tpsim.data.readers.messages import Messages, stamp_of

UNIX = 1_700_000_000_000_000_000


def stamp(seconds):
    ns = UNIX + round(seconds * 1e9)
    return Message(sec=ns // 10**9, nanosec=ns % 10**9)


def xyz(values):
    return Message(**dict(zip("xyz", map(float, values), strict=True)))


def xyzw(rotation):
    return Message(**dict(zip("xyzw", map(float, rotation.as_quat()), strict=True)))


def transform(seconds, parent, child, p, rotation):
    header = Message(stamp=stamp(seconds), frame_id=parent)
    inner = Message(translation=xyz(p), rotation=xyzw(rotation))
    return Message(header=header, child_frame_id=child, transform=inner)


def joints(seconds, names, position):
    header = Message(stamp=stamp(seconds), frame_id="")
    return Message(header=header, name=names, position=position, velocity=[], effort=[])


def recording(messages):
    return Recording("a bag", messages.series(), clock=True)


def test_a_tool_on_a_turning_base_in_the_world():
    """The base turns at a constant rate, so that interpolation between its stamps is exact."""
    messages = Messages()
    messages.add("/tf_static", "tf2_msgs/msg/TFMessage", 1, Message(
        transforms=[transform(-3600, "/world", "mount", [0, 0, 1], Rotation.identity())]
    ))  # fmt: skip

    def base(t):
        return np.array([0.1 * t, 0, 0]), Rotation.from_euler("z", 0.8 * np.atleast_1d(t)[:, None])

    def tool(t):
        turn = Rotation.from_euler("x", 0.3 * np.atleast_1d(t)[:, None])
        return np.array([0.5, 0.1 * np.sin(t), 0]), turn

    times = np.arange(0, 2, 0.02)
    for t in np.arange(0, 2.2, 0.2):
        p, R = base(t)
        one = transform(t, "mount", "base", p, R[0])
        messages.add("/tf", "tf2_msgs/msg/TFMessage", 1, Message(transforms=[one]))
    for t in times:
        p, R = tool(t)
        one = transform(t, "base", "tool", p, R[0])
        messages.add("/tf", "tf2_msgs/msg/TFMessage", 1, Message(transforms=[one]))

    pose = {"position": "tf/tool/position/?", "orientation": "tf/tool/orientation/?"}
    (d,) = demonstrations_of([recording(messages)], Columns(**pose, order="wxyz", frames=["mount"]))
    np.testing.assert_allclose(d.time, times, atol=1e-9)
    for t, found in zip(times, d.data, strict=True):
        (p_base, R_base), (p_tool, R_tool) = base(t), tool(t)
        expected = np.array([0, 0, 1]) + p_base + R_base[0].apply(p_tool)
        np.testing.assert_allclose(found[:3], expected, atol=1e-7)
        turn = (R_base[0] * R_tool[0]).as_quat(scalar_first=True)
        assert abs(turn @ found[3:]) == pytest.approx(1, abs=1e-9)
    np.testing.assert_array_equal(d.frames[0].b[:3], [0, 0, 1])


def test_two_publishers_on_one_topic_are_two_series():
    messages = Messages()
    for i in range(20):
        kind = "sensor_msgs/msg/JointState"
        messages.add("/joint_states", kind, 1, joints(0.01 * i, ["a", "b"], [i, 2 * i]))
        if i % 4 == 0:
            messages.add("/joint_states", kind, 1, joints(0.01 * i + 0.005, ["finger"], [0.1 * i]))
    (d,) = demonstrations_of([recording(messages)], Columns())
    np.testing.assert_array_equal(d.data, np.outer(np.arange(20), [1, 2]))
    both = Columns(joints=["/joint_states/?/position", "/joint_states/finger/position"])
    (d,) = demonstrations_of([recording(messages)], both)
    # Cut to where the finger is known as well, at the stamps of the arm.
    np.testing.assert_allclose(d.data[:, 2], 0.1 * (d.data[:, 0] - 0.5), atol=1e-9)
    np.testing.assert_array_equal(d.data[:, 0], np.arange(1, 17))


def test_series_that_share_no_time():
    messages = Messages()
    for i in range(3):
        messages.add("/a", "std_msgs/Float64", UNIX + i, Message(data=float(i)))
        messages.add("/b", "std_msgs/Float64", UNIX + 10 + i, Message(data=float(i)))
    with pytest.raises(TpsimError, match="share no time"):
        demonstrations_of([recording(messages)], Columns(other=["/a/data", "/b/data"]))


def test_pictures_words_and_long_arrays_are_passed_over():
    messages = Messages()
    messages.add("/camera", "sensor_msgs/msg/Image", 1, Message(height=480, data=b"..."))
    messages.add("/log", "rcl_interfaces/msg/Log", 1, Message(level=20, msg="hello"))
    messages.add("/scan", "my_msgs/msg/Scan", 1, Message(ranges=np.zeros(5000)))
    assert messages.series() == ()


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (Message(header=Message(stamp=Message(sec=2, nanosec=5))), 2_000_000_005),
        (Message(header=Message(stamp=Message(secs=2, nsecs=5))), 2_000_000_005),
        (Message(timestamp=Message(sec=2, nsec=5)), 2_000_000_005),
        (Message(header=Message(stamp=Message(sec=0, nanosec=0))), 77),
        (Message(data=1.0), 77),
    ],
)
def test_stamps(message, expected):
    assert stamp_of(message, logged=77) == expected
