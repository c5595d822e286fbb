"""Stiffness that is felt, measured beside what is commanded."""

import numpy as np
import pytest
from scipy.linalg import eigh

from tpsim.errors import SimulationError
from tpsim.study.identify import HELD, SLOW, identify_stiffness
from tpsim.world.impedance import Impedance

from .toy import HOME, Bring


class Creeping:
    """Stiff in one mode; in the other a weak pull towards far away, slowed by much damping."""

    def __init__(self, robot, pull=0.05, stiff=400.0):
        M = robot.at(HOME).mass
        _, V = eigh(np.diag([2.0, 1.0]), M)
        P = M @ V
        self.impedance = Impedance(
            (P * [stiff, pull]) @ P.T,
            (P * [2 * stiff**0.5, 10.0]) @ P.T,
            np.array(HOME) + 2.0 * V[:, 1],
        )
        self.modes = P

    def command(self, state, time):
        return self.impedance


def test_what_creeps_does_not_keep_the_stiff_modes_from_being_measured():
    world = Bring().world()
    controller = Creeping(world.robot)
    # It moves too fast, all the time, to count as at rest.
    speed = 0.05 * 2.0 / 10.0
    assert speed > 5 * SLOW and speed * HELD < 0.1
    measured, commanded = identify_stiffness(world, controller, np.array(HOME))
    assert commanded.shape == (1, 1)
    assert measured == pytest.approx(commanded, rel=0.01)


def test_nothing_stiff_is_said():
    world = Bring().world()
    with pytest.raises(SimulationError, match="no mode is stiffer"):
        identify_stiffness(world, Creeping(world.robot, stiff=50.0), np.array(HOME))
