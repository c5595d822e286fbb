import threading
import time
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


@pytest.fixture(scope="module")
def page(study, taught, tmp_path_factory):
    """The playground of the toy study; no thread may be left of it."""
    from tpsim.play import page as pages
    from tpsim.play.playground import playground
    from tpsim.play.server import Address

    pages.FRAMES = 5.0  # enough for tests, and little work without a graphics card
    folder = tmp_path_factory.mktemp("played") / "kept"
    before = set(threading.enumerate())
    with playground(
        study, Address("127.0.0.1", 0), source=taught, folder=folder, apart=False
    ) as page:
        yield page
    names = [t.name for t in set(threading.enumerate()) - before if t.name.startswith("tpsim")]
    assert names == [], "threads are left"


@pytest.fixture
def wait_for():
    """Wait until something is so; what draws without a graphics card takes its time."""

    def wait(condition, what, patience=30.0):
        end = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < end, f"waited in vain for {what}"
            time.sleep(0.02)

    return wait
