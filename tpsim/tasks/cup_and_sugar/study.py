"""The study of cup and sugar: pushes, a pushed elbow, a led hand, beside fixed gains."""

import numpy as np

from tpsim.controllers.renewed import FixedImpedance
from tpsim.study.identify import identify_stiffness
from tpsim.study.study import ControllerFactory, Lab, Study
from tpsim.task.task import Models, Situation
from tpsim.tasks.cup_and_sugar import pictures
from tpsim.tasks.cup_and_sugar.conditions import conditions
from tpsim.tasks.cup_and_sugar.experts import contest
from tpsim.tasks.cup_and_sugar.measures import measures
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.world.world import World

STIFF, SOFT = 2000.0, 40.0
"""Constant joint gains [1/s^2] of the controllers to compare with."""


def fixed(stiffness: float) -> ControllerFactory:
    """Constant gains about the start posture."""

    def controller(world: World, models: Models, situation: Situation) -> FixedImpedance:
        return FixedImpedance(np.array(situation.start), stiffness)

    return controller


def stiffness_error(lab: Lab) -> float:
    """Physical stiffness of all stiff modes beside the commanded one, error [%]."""
    world, home = lab.world, lab.world.robot.home
    controller = lab.task.controller(world, lab.models, Situation(tuple(home)))
    measured, commanded = identify_stiffness(world, controller, home)
    return float(100 * np.linalg.norm(measured - commanded) / np.linalg.norm(commanded))


def study(task: CupAndSugar) -> Study:
    """The study of one or both behaviours."""
    return Study(
        task,
        measures,
        controllers={"stiff": fixed(STIFF), "soft": fixed(SOFT)},
        conditions=conditions,
        contest=contest(task),
        of=study,
        probes={"stiffness_error_percent": stiffness_error},
        title="Cup and sugar",
        lead=(
            "Two behaviours were taught apart by leading the weightless arms: hold the cup level, "
            "and keep the sugar above it. The robot performs both at once where it was never "
            "shown, stiff where the teacher was precise and soft where the teacher did not care."
        ),
        sections=pictures.sections,
        clips=pictures.clips,
    )


cup_and_sugar = study(CupAndSugar())
cup = study(CupAndSugar(("cup",)))
sugar = study(CupAndSugar(("sugar",)))
