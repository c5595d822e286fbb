from pathlib import Path

import numpy as np
import pytest

from tpsim.study.condition import Condition, Lead
from tpsim.study.executor import perform_all
from tpsim.study.files.run import open_run
from tpsim.study.reference import load_study
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, teach
from tpsim.world.people.push import Push
from tpsim.world.perception import Perception
from tpsim.world.plant import Plant

TOY = Path(__file__).parent / "toy.py"


@pytest.fixture(scope="session")
def toy():
    """The toy study, as a user's file."""
    return load_study(f"{TOY}:study")


@pytest.fixture(scope="session")
def taught(toy):
    return teach(toy.task)


@pytest.fixture(scope="session")
def models(toy, taught):
    return learn(toy.task, taught)


@pytest.fixture(scope="session")
def conditions(toy):
    """One condition of every kind."""
    first, second, third = (draw_situation(toy.task, 0, i) for i in range(3))
    tip = toy.task.stage.robot.at(np.array(third.start)).pose("tip").position
    lead = Lead("tip", tuple(tip.tolist()), (0.0, 0.01, 0.0), 0.1, 0.1, 0.05)
    camera = Perception(rate=15.0, occluded=(("mark", 0.1, 0.2),), seed=1)
    plant = Plant(mass=0.1, latency=0.004, velocity_cutoff=float("inf"), perception=camera, seed=3)
    return [
        Condition("unpushed", first),
        Condition("pushed", second, "nearby", (Push("tip", (1.0, 2.0, 0.0), 0.1, 0.1),)),
        Condition("led", third, "still", lead=(lead,), plant=plant, duration=0.3),
        Condition("taught", second, shown="bring"),
    ]


@pytest.fixture(scope="session")
def trials(toy, models, conditions):
    return list(perform_all(toy, models, conditions))


@pytest.fixture
def recorded(tmp_path, toy, models, trials):
    """A whole run."""
    run = open_run(tmp_path / "run", study=toy, command="toy", configuration={"n": 4}, seed=0)
    run.save_models(models)
    for index, trial in enumerate(trials):
        run.save(index, trial)
    return run.finish()
