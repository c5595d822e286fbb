"""What is stiff comes out of the demonstrations: another teacher, another stiff direction."""

import numpy as np
import pytest

from tpsim import tasks
from tpsim.sim.teach import teach
from tpsim.tasks import cup
from tpsim.tasks.bimanual import Hands, Workspace


@pytest.fixture(scope="module")
def by_height():
    """Learned from a teacher who keeps the height and lets the cup tilt."""
    task = tasks.load("cup")
    simulation = task.simulation()
    hands = Hands(simulation)
    careless = Workspace(tilt=0.25)
    trials = teach(
        simulation,
        lambda simulation, rng: cup.lesson(hands, rng, careless, level=0.0),
        3,
        seed=0,
        sites=task.sites,
    )
    return task.learn(simulation, "cup", trials, 1)


def test_the_stiff_direction_moves_with_what_the_teacher_fixes(by_height):
    task = tasks.load("cup")
    from tpsim.experiment.teaching import recorded

    level = task.learn(task.simulation(), "cup", recorded(task)["cup"], 1)
    height, tilt = 2, [3, 4]
    deviation = {
        name: np.sqrt(np.diag(model.frames[0].covariance[0]))
        for name, model in (("level", level), ("height", by_height))
    }
    assert deviation["height"][height] < 0.15 * deviation["level"][height]
    assert (deviation["height"][tilt] > 2.5 * deviation["level"][tilt]).all()


def test_situations_are_drawn_from_their_seed_alone():
    task = tasks.load("cup-and-sugar")
    simulation = task.simulation()
    one, other = (task.situation(simulation, 5, 2) for _ in range(2))
    assert one == other
    assert task.situation(simulation, 5, 3) != one
    assert task.is_comfortable(simulation, np.array(one.start))
