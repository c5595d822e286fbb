"""A learned task for every kind of controller, and its policy out of a folder."""

from functools import cache

import pytest

from tpsim.deploy.policy import Policy
from tpsim.study.teaching_files import read_demonstrations
from tpsim.task.verbs import learn, teach
from tpsim.tasks.cup_and_sugar.task import CupAndSugar
from tpsim.tasks.pointing.task import Pointing
from tpsim.tasks.tracking.task import Tracking
from tpsim.tasks.transfer.task import Transfer

TASKS = {
    "MinimalIntervention": CupAndSugar(),
    "MinimalIntervention that holds its start": CupAndSugar(("cup",)),
    "TimedIntervention": Pointing(),
    "Pursuit": Tracking(("left",)),
    "FiniteHorizon": Transfer(),
}


@pytest.fixture(scope="session")
def learned():
    """Task and models by kind of controller, each learned when it is first asked for."""

    @cache
    def learned(kind):
        task = TASKS[kind]
        cup = isinstance(task, CupAndSugar)
        taught = (
            read_demonstrations(task)
            if cup
            else teach(task, 1 if isinstance(task, Tracking) else 2)
        )
        return task, learn(task, taught)

    return learned


@pytest.fixture(scope="session")
def folder_of(learned, tmp_path_factory):
    """Folder of a policy by kind of controller."""

    @cache
    def folder_of(kind):
        return Policy(*learned(kind)).save(tmp_path_factory.mktemp("policies") / "policy")

    return folder_of
