"""A task on a robot whose joints have no limits."""

import pytest


@pytest.fixture(scope="session")
def planar_task():
    """An arm of two links in the plane, whose joints turn freely."""
    from tpsim.robot.robot import Robot
    from tpsim.scene.compose import world
    from tpsim.task.task import Behaviour, Situation, Task

    text = """<mujoco><worldbody><body><joint name="a" axis="0 0 1" armature="0.1"/>
    <geom size="0.1" mass="1"/><body pos="0.3 0 0"><joint name="b" axis="0 0 1" armature="0.1"/>
    <geom size="0.05" mass="1"/><site name="tip" pos="0.3 0 0"/></body></body></worldbody></mujoco>
    """

    class Free(Task):
        def world(self):
            return world(Robot.from_mjcf(text, {"hand": "tip"}, torque_limit=5, home=(0.1, 0.2)))

        def behaviours(self):
            from tpsim.robot.views.joints import Joints

            return {"free": Behaviour({"posture": Joints()}, self.situation)}

        def situation(self, world, rng):
            return Situation(rng.uniform(-1, 1, 2))

        def controller(self, world, models, situation):
            raise NotImplementedError

    return Free()
