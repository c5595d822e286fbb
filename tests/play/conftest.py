from pathlib import Path

import pytest

TOY = Path(__file__).parents[1] / "study" / "toy.py"


@pytest.fixture(scope="session")
def study():
    """The toy study: a two-link arm that brings its tip to a mark."""
    from tpsim.study.reference import load_study

    return load_study(f"{TOY}:study")


@pytest.fixture(scope="session")
def taught(study):
    from tpsim.task.verbs import teach

    return teach(study.task, 2)


@pytest.fixture(scope="session")
def models(study, taught):
    from tpsim.task.verbs import learn

    return learn(study.task, taught)
