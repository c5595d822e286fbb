"""The hand stays above a marker, wherever the marker is put: a task and its study."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from laboratory import robots
from tpsim import lab

ROBOTS = {"jaco": robots.jaco, "servo": robots.servo_arm}
MARKER, ABOVE = lab.Object("marker"), (0.0, 0.0, 0.12)


@dataclass(frozen=True)
class Hover(lab.Task):
    robot: Literal["jaco", "servo"] = "jaco"
    effort: float = 0.02
    duration = 4.0

    def world(self):
        return lab.world(ROBOTS[self.robot](), objects={"marker": "marker"})

    @property
    def gap(self):
        return lab.Site(self.stage.robot.hands["hand"]).seen_from(MARKER).position.minus(ABOVE)

    def behaviours(self):
        views = {"from marker": self.gap, "posture": lab.Joints()}
        return {"hover": lab.Behaviour(views, self.lesson)}

    def draw(self, world, rng):
        robot, hand = world.robot, lab.Site(world.robot.hands["hand"])
        p = robot.at_home.pose(hand.name).position + rng.uniform(-0.1, 0.1, 3)
        near = robot.home + 0.25 * rng.standard_normal((4, robot.n))
        postures = [lab.satisfy(robot, [hand.position.minus(p)], q) for q in near]
        return lab.ObjectPath.at("marker", p - ABOVE), p, postures

    def lesson(self, world, rng):
        hand, (marker, p, postures) = world.robot.hands["hand"], self.draw(world, rng)
        turns = [world.robot.at(q).pose(hand).rotation for q in postures]
        path = lab.script(turns, [p] * 4, self.duration, world.timestep, rng)
        guide = lab.Guide("teacher", hand, lab.Grip(5000, 200), path)
        return lab.Lesson(postures[0], (guide,), self.duration, objects=(marker,))

    def situation(self, world, rng):
        start = self.draw(world, rng)[2][0]
        return lab.Situation(start, (self.draw(world, rng)[0],))

    def controller(self, world, models, situation):
        skill = lab.Skill(self.behaviours()["hover"].views, models["hover"])
        return lab.MinimalIntervention([skill], effort=self.effort)


def gap(record):
    return 1e3 * np.linalg.norm(record.see(record.task.gap), axis=1)


measures = [lab.Measure("gap_mm", gap, "mm", label="unpushed", window=(3, 4), limit=10)]
study = lab.Study(Hover(), measures)
