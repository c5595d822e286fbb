"""The laboratory, flat: robots, views, tasks, controllers, measures and studies as values.

A whole user study. Robot and objects become a world; views are what a task is seen from; a teacher
leads the weightless arm; what was learned drives the robot where it was never shown::

    from dataclasses import dataclass
    from tpsim import lab

    TIP, CUP = lab.Site("tool"), lab.Object("cup")

    @dataclass(frozen=True)
    class Visit(lab.Task):
        effort: float = 0.1  # [s^4/(kg m^2)]; an option: tpsim run visit.py:study --effort 0.2

        def world(self):
            robot = lab.Robot.from_mjcf("arm.xml", hands={"hand": "tool"}, torque_limit=40)
            return lab.world(robot, objects={"cup": "marker"})

        def behaviours(self):
            views = {"from cup": TIP.seen_from(CUP).position, "posture": lab.Joints()}
            return {"visit": lab.Behaviour(views, self.lesson)}

        def situation(self, world, rng): ...  # start posture and where the cup is
        def lesson(self, world, rng): ...  # how a person shows it

        def controller(self, world, models, situation):
            skill = lab.Skill(self.behaviours()["visit"].views, models["visit"])
            return lab.MinimalIntervention([skill], effort=self.effort)  # holds what was taught

    gap = lab.Measure("gap_mm", TIP.seen_from(CUP).position, "mm", limit=10)
    study = lab.Study(Visit(), [gap])

``tpsim run visit.py:study`` then teaches, learns, performs, pushes, films and reports; in Python
:func:`teach`, :func:`learn`, :func:`perform` and :func:`run` do the same step by step.
:class:`MinimalIntervention` holds what was taught, wherever a push or an object leads it; a
movement in time is followed by :class:`TimedIntervention`, as in ``docs/recipes/task.md``.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from tpsim.campaign.campaign import Campaign as Campaign
from tpsim.campaign.campaign import Sweep as Sweep
from tpsim.campaign.people import Leads as Leads
from tpsim.campaign.people import Pushes as Pushes
from tpsim.campaign.people import Span as Span
from tpsim.catalogue.arms import Arms as Arms
from tpsim.control.pose_filter import PoseFilter as PoseFilter
from tpsim.controllers.cartesian import CartesianImpedance as CartesianImpedance
from tpsim.controllers.cartesian import Spring as Spring
from tpsim.controllers.computed_torque import ComputedTorque as ComputedTorque
from tpsim.controllers.computed_torque import InverseKinematics as InverseKinematics
from tpsim.controllers.computed_torque import Motion as Motion
from tpsim.controllers.finite_horizon import FiniteHorizon as FiniteHorizon
from tpsim.controllers.minimal_intervention import MinimalIntervention as MinimalIntervention
from tpsim.controllers.operational_space import Aim as Aim
from tpsim.controllers.operational_space import OperationalSpace as OperationalSpace
from tpsim.controllers.product import Skill as Skill
from tpsim.controllers.pursuit import Pursuit as Pursuit
from tpsim.controllers.renewed import FixedImpedance as FixedImpedance
from tpsim.controllers.renewed import RenewedImpedance as RenewedImpedance
from tpsim.controllers.semi_markov import SemiMarkovTracking as SemiMarkovTracking
from tpsim.controllers.timed_intervention import TimedIntervention as TimedIntervention
from tpsim.deploy.cartesian import CartesianLimits as CartesianLimits
from tpsim.deploy.policy import Policy as Policy
from tpsim.film.clip import Clip as Clip
from tpsim.pose import Pose as Pose
from tpsim.robot.gripper import Gripper as Gripper
from tpsim.robot.indices import Chain as Chain
from tpsim.robot.robot import Robot as Robot
from tpsim.robot.state import State as State
from tpsim.robot.views.joints import Joints as Joints
from tpsim.robot.views.observe import observe as observe
from tpsim.robot.views.sites import Object as Object
from tpsim.robot.views.sites import Site as Site
from tpsim.robot.views.timed import Handover as Handover
from tpsim.robot.views.timed import OnPath as OnPath
from tpsim.robot.views.view import Seen as Seen
from tpsim.robot.views.view import View as View
from tpsim.scene.camera import Camera as Camera
from tpsim.scene.compose import Held as Held
from tpsim.scene.compose import Placed as Placed
from tpsim.scene.compose import world as world
from tpsim.study.condition import Condition as Condition
from tpsim.study.condition import Lead as Lead
from tpsim.study.contest import Contest as Contest
from tpsim.study.contest import Error as Error
from tpsim.study.expert import Expert as Expert
from tpsim.study.expert import Range as Range
from tpsim.study.measure import Measure as Measure
from tpsim.study.measure import rms as rms
from tpsim.study.pareto import pareto as pareto
from tpsim.study.record import Record as Record
from tpsim.study.record import Records as Records
from tpsim.study.reference import load_study as load_study
from tpsim.study.running import run as run
from tpsim.study.study import Lab as Lab
from tpsim.study.study import Plan as Plan
from tpsim.study.study import Study as Study
from tpsim.study.study import pushes_all_round as pushes_all_round
from tpsim.study.tuning import tune as tune
from tpsim.task.task import Behaviour as Behaviour
from tpsim.task.task import Goal as Goal
from tpsim.task.task import Situation as Situation
from tpsim.task.task import Task as Task
from tpsim.task.task import draw_situation as draw_situation
from tpsim.task.verbs import learn as learn
from tpsim.task.verbs import perform as perform
from tpsim.task.verbs import teach as teach
from tpsim.world.grasp import Grasp as Grasp
from tpsim.world.impedance import Controller as Controller
from tpsim.world.impedance import Impedance as Impedance
from tpsim.world.object_path import ObjectPath as ObjectPath
from tpsim.world.people.care import Care as Care
from tpsim.world.people.demonstrator import FIRM as FIRM
from tpsim.world.people.demonstrator import HUMAN as HUMAN
from tpsim.world.people.demonstrator import Demonstrator as Demonstrator
from tpsim.world.people.drag import Drag as Drag
from tpsim.world.people.guide import Grip as Grip
from tpsim.world.people.guide import Guide as Guide
from tpsim.world.people.hold import Hold as Hold
from tpsim.world.people.posture_script import hand_path as hand_path
from tpsim.world.people.posture_script import through as through
from tpsim.world.people.push import Push as Push
from tpsim.world.people.script import Variation as Variation
from tpsim.world.people.script import script as script
from tpsim.world.people.script import straight as straight
from tpsim.world.people.sight import Sight as Sight
from tpsim.world.perception import Perception as Perception
from tpsim.world.plant import PLANTS as PLANTS
from tpsim.world.plant import Plant as Plant
from tpsim.world.reach import reach as reach
from tpsim.world.reach import satisfy as satisfy
from tpsim.world.rehearsal import Rehearsed as Rehearsed
from tpsim.world.rollout import rollout as rollout
from tpsim.world.tank import UNLIMITED as UNLIMITED
from tpsim.world.tank import Tank as Tank
from tpsim.world.teaching import Lesson as Lesson
from tpsim.world.trial import Trial as Trial
from tpsim.world.weightless import Weightless as Weightless
from tpsim.world.world import World as World

if TYPE_CHECKING:
    from tpsim.campaign.run import campaign as campaign
    from tpsim.task.environment import environment as environment
    from tpsim.task.gymnasium import gym_environment as gym_environment

_LATER = {
    "campaign": "tpsim.campaign.run",
    "environment": "tpsim.task.environment",
    "gym_environment": "tpsim.task.gymnasium",
}


def __getattr__(name: str) -> object:
    """Import when asked for what takes time, or needs packages that may be missing."""
    if name in _LATER:
        return getattr(import_module(_LATER[name]), name)
    raise AttributeError(f"module 'tpsim.lab' has no attribute '{name}'")
