"""Robots that nobody here wrote, taken in once for all tests."""

import pytest

from tpsim.catalogue.robots import CATALOGUE, find


@pytest.fixture(scope="session")
def robot_of():
    """Give a robot by its name; the test is skipped where its package is missing."""

    def found(name):
        if not CATALOGUE[name].is_at_hand:
            pytest.skip(f"{CATALOGUE[name].package} is not installed")
        return find(name)

    return found
