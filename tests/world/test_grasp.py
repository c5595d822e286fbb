"""Things that a hand takes, carries, lets fall: welds that close and open by themselves."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from tpsim import lab
from tpsim.errors import SimulationError
from tpsim.world.grasp import TEXT, Grasp, read_grasps
from tpsim.world.impedance import Impedance
from tpsim.world.rollout import Rollout

MASS = '<geom size=".01" mass="1" contype="0" conaffinity="0"/>'
GANTRY = f"""<mujoco><option timestep="0.001"/><worldbody>
<body name="x"><joint name="x" type="slide" axis="1 0 0"/>{MASS}
<body name="z"><joint name="z" type="slide" axis="0 0 1"/>{MASS}<site name="tip"/></body></body>
</worldbody></mujoco>"""

GRASP = Grasp(
    "lump",
    "tip",
    (0.0, 0.0, -0.01),
    ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    stand="stand",
    on_stand=(0.0, 0.0, 0.009),
    target="dish",
    at_target=(0.0, 0.0, 0.1),
)
STIFFNESS, WEIGHT = 400.0, 0.006 * 9.81


class Stations:
    """Goes to one place after another, as (time, x, z)."""

    def __init__(self, *stations):
        self.stations, self.now = stations, None

    def command(self, state, time):
        place = [s for s in self.stations if time >= s[0]][-1]
        if self.now is None or self.now[0] != place[0]:
            K = STIFFNESS * np.eye(2)
            self.now = place[0], Impedance(K, 60 * np.eye(2), np.array(place[1:]))
        return self.now[1]


@pytest.fixture(scope="module")
def world():
    """A hand on two slides, a lump on a stand at its left, a dish at its right."""
    robot = lab.Robot.from_mjcf(GANTRY, {"hand": "tip"}, torque_limit=100, home=(0.0, 0.2))
    placed = {"stand": (-0.2, 0.0, 0.0), "dish": (0.2, 0.0, 0.0)}
    objects = {name: lab.Placed("saucer", at) for name, at in placed.items()}
    return lab.world(robot, objects=objects, taken={"lump": GRASP})


def going(world, *stations):
    return Rollout(world.simulation(), Stations(*stations), (-0.2, 0.2), sites={"tip": "tip"})


def test_a_thing_that_nobody_takes_lies_on_its_stand_and_touches_nothing_that_counts(world):
    trial = going(world, (0.0, 0.0, 0.2)).run(400).trial()
    assert trial.outcome == "done" and "lump" in trial.channels.objects
    np.testing.assert_allclose(trial["lump_position"][-1], (-0.2, 0, 0.009), atol=5e-4)


def test_a_hand_takes_lifts_carries_and_lets_fall(world):
    stations = (0.0, -0.2, 0.019), (1.6, -0.2, 0.2), (2.6, 0.2, 0.2), (3.8, 0.2, 0.111)
    trial = going(world, *stations).run(6500).trial()
    time, lump, tip = trial.time, trial["lump_position"], trial["tip_position"]
    carried = (time > 2.2) & (time < 4.2)
    # In the middle of the hand, however near it was when the hand closed.
    in_hand = np.tile((0.0, 0.0, -0.01), (carried.sum(), 1))
    np.testing.assert_allclose((lump - tip)[carried], in_hand, atol=5e-4)
    # The model does not know its weight: the spring gives way by m g / K.
    still = int(np.searchsorted(time, 3.75))
    assert 0.2 - tip[still, 2] == pytest.approx(WEIGHT / STIFFNESS, rel=0.1)
    # Let go, it falls freely, and lies where it fell.
    free = int(np.argmax(np.linalg.norm(lump - tip, axis=1) * (time > 4.0) > 0.0105))
    fallen = lump[free, 2] - lump[free + 1 : free + 8, 2]
    since = time[free + 1 : free + 8] - time[free]
    speed = (lump[free - 1, 2] - lump[free + 1, 2]) / 0.02
    np.testing.assert_allclose(fallen, speed * since + 9.81 / 2 * since**2, atol=1e-3)
    np.testing.assert_allclose(lump[-1, 2], 0.009, atol=5e-4)
    assert abs(lump[-1, 0] - 0.2) < 0.01


def test_a_hand_that_only_passes_takes_nothing(world):
    trial = going(world, (0.0, -0.2, 0.019), (0.35, -0.2, 0.2)).run(1500).trial()
    np.testing.assert_allclose(trial["lump_position"][-1], (-0.2, 0, 0.009), atol=5e-4)


def test_a_fork_knows_how_long_the_hand_was_there(world):
    stations = (0.0, -0.2, 0.019), (1.6, -0.2, 0.2)
    alone = going(world, *stations).run(2500).trial()
    push = lab.Push("tip", (0.0, 0.0, 0.0), start=1.0, duration=0.1)
    first = going(world, *stations)
    first.watch([push])
    forked = first.run(900).fork(0).run(2500).trial()
    np.testing.assert_array_equal(forked["lump_position"], alone["lump_position"])


def test_a_scene_holds_its_grasps_as_text_and_says_what_is_wrong_with_them(world):
    again = mujoco.MjModel.from_xml_string(world.xml, dict(world.assets))
    assert read_grasps(again) == {"lump": GRASP}
    assert world.objects == ("stand", "dish", "lump")
    for wrong, said in (("[]", "grasps"), ('{"lump": {"site": 3}}', "grasps"), ("{", "grasps")):
        text = mujoco.MjSpec.from_string(world.xml)
        text.text(TEXT).data = wrong
        with pytest.raises(SimulationError, match=said):
            read_grasps(text.compile())
    robot = lab.Robot.from_mjcf(GANTRY, {"hand": "tip"}, torque_limit=100, home=(0.0, 0.2))
    with pytest.raises(SimulationError, match="nowhere"):
        lab.world(robot, taken={"lump": replace(GRASP, stand="nowhere")})
