"""The Python of the page on real arms runs, with a simulated driver in place of an arm."""

import re
from pathlib import Path

import numpy as np

from tpsim.deploy import Policy

PAGE = Path(__file__).parents[2] / "docs" / "deploy.md"


class Arm:
    """Stands still at the robot's home, and counts what it is commanded."""

    def __init__(self, home):
        self.home, self.steps, self.commands = home, 0, []

    def time(self):
        return 0.001 * self.steps

    def is_running(self):
        self.steps += 1
        return self.steps <= 3

    def state(self):
        return self.home, np.zeros_like(self.home)

    def command(self, torque):
        self.commands.append(torque)

    def set_stiffness(self, hand, value):
        self.commands.append((hand, value))

    def set_damping(self, hand, value):
        assert np.linalg.eigvalsh(value + value.T).min() > -1e-9

    def set_target(self, hand, position, quaternion):
        assert position.shape == (3,) and np.isclose(np.linalg.norm(quaternion), 1)


def test_the_loops_of_the_page_drive_an_arm(folder_of, monkeypatch):
    folder = folder_of("MinimalIntervention that holds its start")
    policy = Policy.load(folder)
    loops = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(loops) == 2
    for code, commands in zip(loops, (3, 6), strict=True):
        arm = Arm(np.array(policy.robot.home))
        names = {"arm": arm, "camera": None}
        exec(code.replace('"cup-policy"', repr(str(folder))), names)
        assert names["policy"].objects == ()
        assert len(arm.commands) == commands
    torques = arm.commands
    assert {hand for hand, _ in torques} == set(names["hands"])
    for _, stiffness in torques:
        assert stiffness.shape == (6, 6) and np.linalg.eigvalsh(stiffness).min() > -1e-9
