"""Small originals of everything that tpsim reads."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from tpsim.deploy.policy import Policy
from tpsim.section8 import METHODS
from tpsim.section8.plan import Plan
from tpsim.section8.run import run as run_cells
from tpsim.study.condition import Condition
from tpsim.study.executor import perform_all
from tpsim.study.files.run import open_run
from tpsim.study.reference import load_study
from tpsim.study.teaching_files import write_demonstrations
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, teach
from tpsim.world.people.push import Push

from ..test_archive import VALUES

TOY = Path(__file__).parents[1] / "study" / "toy.py"


@pytest.fixture(scope="session")
def toy():
    """The toy study, and what was taught and learned of it."""
    study = load_study(f"{TOY}:study")
    taught = teach(study.task, 2)
    return SimpleNamespace(study=study, taught=taught, models=learn(study.task, taught))


@pytest.fixture(scope="session")
def a_run(toy, tmp_path_factory):
    """A whole run of three trials, each of another kind, with its demonstrations."""
    return _run(toy, tmp_path_factory.mktemp("run") / "run", 0)


@pytest.fixture(scope="session")
def another_run(toy, tmp_path_factory):
    """The same of another seed."""
    return _run(toy, tmp_path_factory.mktemp("other") / "run", 1)


def _run(toy, folder, seed):
    situation = draw_situation(toy.study.task, seed, 0)
    push = Push("tip", (1.0, 2.0, 0.0), 0.02, 0.05)
    conditions = [
        Condition("unpushed", situation, duration=0.1),
        Condition("pushed", situation, "still", push=(push,), duration=0.1),
        Condition("taught", situation, shown="bring"),
    ]
    run = open_run(folder, study=toy.study, command="toy", configuration={"n": 3}, seed=seed)
    where = folder / "demonstrations" / "bring"
    shown = [trial.with_about(seed=seed) for trial in toy.taught["bring"]]
    write_demonstrations(where, toy.study, "bring", shown, seed=seed, command="toy")
    run.save_models(toy.models)
    for index, trial in enumerate(perform_all(toy.study, toy.models, conditions)):
        run.save(index, trial)
    run.finish()
    (folder / "report.html").write_text("what is drawn is no part of the record")
    return folder


@pytest.fixture(scope="session")
def models(tmp_path_factory):
    """A folder with a file of every kind of value and model."""
    folder = tmp_path_factory.mktemp("models") / "models"
    for kind, make in VALUES.items():
        make().save(folder / f"{kind}.npz")
    return folder


@pytest.fixture(scope="session")
def policy(toy, tmp_path_factory):
    """Folder of a policy."""
    folder = tmp_path_factory.mktemp("policies") / "policy"
    return Policy(toy.study.task, toy.models).save(folder)


@pytest.fixture(scope="session")
def cells(tmp_path_factory):
    """Folder of a small comparison, its plan and its methods."""
    plan = Plan(("transfer",), (2,), (0, 1), (1.0,), situations=2, samples=20)
    methods = {"TP-LWR": METHODS["TP-LWR"]}
    folder = tmp_path_factory.mktemp("compare") / "compare"
    run_cells(plan, methods, folder)
    return SimpleNamespace(folder=folder, plan=plan, methods=methods)
