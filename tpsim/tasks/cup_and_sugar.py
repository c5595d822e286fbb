"""The tutorial's bimanual example (Section 6, Fig. 9): cup, sugar, and both at once.

Two behaviours are taught apart: the left hand holds a cup level, the right hand holds a sugar
cube above it. ``cup-and-sugar`` performs the product of the two learned controllers.
"""

from collections.abc import Mapping

import numpy as np

from tpsim import rotation
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim import scene
from tpsim.sim.controllers.controller import Behaviour, Controller, FixedImpedance
from tpsim.sim.controllers.minimal_intervention import MinimalIntervention
from tpsim.sim.simulation import Simulation
from tpsim.tasks import cup, sugar
from tpsim.tasks.bimanual import SITES, Hands
from tpsim.tasks.task import Task

EFFORT = 0.3
"""Cost of acceleration [s^4/(kg m^2)]: the one number that sets how soft the robot is."""

FIXED = {"stiff": 2000.0, "soft": 40.0}
"""Constant joint gains [1/s^2] of the controllers to compare with."""

HOLD = 0.1
"""Standard deviation [rad] with which joints that no behaviour was taught hold their start."""

LEVEL, ABOVE = float(np.radians(5.0)), 0.015
"""Tilt of the cup [rad] and distance of the sugar from its place [m] up to which all is well."""

_BEHAVIOURS = {"cup": cup, "sugar": sugar}


class CupAndSugar(Task):
    """One or both of the behaviours on Baxter.

    Parameters
    ----------
    name : str
    behaviours : tuple of str
        Out of ``"cup"``, ``"sugar"``.
    """

    sites = SITES
    duration = 6.0

    def __init__(self, name: str, behaviours: tuple[str, ...]):
        self.name, self.behaviours = name, behaviours

    def simulation(self, xml: str | None = None) -> Simulation:
        """Baxter with a cup in its left hand and a sugar cube in its right one."""
        return Simulation(scene.cup_and_sugar() if xml is None else xml)

    def lesson(self, simulation, behaviour, rng):
        """Draw one demonstration of a behaviour."""
        return _BEHAVIOURS[behaviour].lesson(Hands(simulation), rng)

    def coordinates(self, simulation, behaviour):
        """Candidate frames of a behaviour."""
        frames = Hands(simulation).coordinates()
        return tuple(frames[name] for name in _BEHAVIOURS[behaviour].FRAMES)

    def draw(self, simulation, rng):
        """Draw a start posture: level cup, and sugar above it where that was taught."""
        start = _BEHAVIOURS[self.behaviours[-1]].situation(Hands(simulation), rng)
        return start, {}

    def controller(
        self, simulation, models: Mapping[str, TPGMM], start, kind="learned"
    ) -> Controller:
        """The learned controller, or a fixed-gain one (``"stiff"``, ``"soft"``) about ``start``."""
        robot = simulation.robot
        if kind in FIXED:
            return FixedImpedance(robot, start, FIXED[kind])
        behaviours = [
            Behaviour(name, self.coordinates(simulation, name), models[name])
            for name in self.behaviours
        ]
        prior = None
        if self.behaviours == ("cup",):
            # The right arm was not taught: it holds still. 10 rad say nothing about the left one.
            deviation = np.where([j.startswith("right") for j in robot.joints], HOLD, 10.0)
            prior = Gaussian(np.array(start), np.diag(deviation**2))
        return MinimalIntervention(robot, behaviours, effort=EFFORT, prior=prior)

    def errors(self, simulation):
        """Tilt of the cup [rad], and distance [m] of the sugar from its place above it."""
        robot, (_, place) = simulation.robot, Hands(simulation).above
        cup, sugar = robot.site("cup"), robot.site("sugar")

        def evaluate():
            R, p = robot.placement(cup)
            _, p_sugar = robot.placement(sugar)
            errors = {
                "cup": (float(rotation.tilt(R)), LEVEL),
                "sugar": (float(np.linalg.norm(R.T @ (p_sugar - p) - place)), ABOVE),
            }
            return {name: errors[name] for name in self.behaviours}

        return evaluate


def task(name: str) -> CupAndSugar:
    """The task called ``cup``, ``sugar`` or ``cup-and-sugar``."""
    return CupAndSugar(name, tuple(name.split("-and-")))
