"""What is measured of a hand that was held: jumps of torque, and how far it ends from its goal."""

from types import SimpleNamespace

import numpy as np
import pytest

from tpsim.study.held import held_ratio, release_jump
from tpsim.world.people.hold import Hold


def record(torque=None, end=0.0, hold=()):
    time = np.arange(0, 2, 0.01)
    trial = SimpleNamespace(arrays={}, time=time)
    signals = {"torque": np.zeros((200, 2)) if torque is None else torque}
    trial = type("Trial", (), {"time": time, "__getitem__": lambda self, name: signals[name]})()
    robot = SimpleNamespace(torque_limit=np.array([10.0, 2.0]))
    return SimpleNamespace(
        condition=SimpleNamespace(hold=hold),
        trial=trial,
        task=SimpleNamespace(stage=SimpleNamespace(robot=robot)),
        end=end,
    )


def test_the_jump_is_the_largest_change_just_after_letting_go():
    torque = np.zeros((200, 2))
    torque[:80] = 5.0  # before letting go, whatever it is
    torque[80:100] = [1.0, -0.5]
    torque[104:] = [2.0, 0.1]  # 10 % and 30 % within 0.1 s
    torque[115:] = 9.0  # later
    hold = (Hold("hand", 0.2, 0.8),)
    assert release_jump(record(torque, hold=hold)) == pytest.approx(30.0)
    assert release_jump(record(torque)) is None
    assert release_jump(record(torque, hold=(Hold("hand", 1.9, 3.0),))) is None


def test_the_ratio_is_that_of_the_worst_end():
    found = {"held": [0.4, 0.6], "unpushed": [0.5, 0.3]}

    class All:
        def select(self, label, controller):
            return [record(end=e) for e in found.get(label, ())] if controller == "mine" else []

    near = lambda r: np.array([0.0, r.end])  # noqa: E731
    far = lambda r: np.array([r.end + 1.0])  # noqa: E731
    assert held_ratio("mine", near, far)(All()) == pytest.approx(0.6 / 0.5)
    assert held_ratio("other", near)(All()) is None
