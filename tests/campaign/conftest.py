from pathlib import Path

import pytest

from tpsim.campaign.campaign import Campaign
from tpsim.campaign.people import Pushes
from tpsim.campaign.run import campaign

TOY = f"{Path(__file__).parents[1] / 'study' / 'toy.py'}:study"


@pytest.fixture(scope="session")
def described():
    """Two controllers on two plants under six pushes in each of two situations, and a bit."""
    return Campaign(
        TOY,
        26,
        controllers=("learned", "still"),
        plants=("nominal", "latency 5 ms"),
        pushes=Pushes(direction=((0, 1, 0),), force=(1.0, 2.0), onset=(0.1,), duration=(0.1,)),
        keep="everything",
    )


@pytest.fixture(scope="session")
def undisturbed(described, tmp_path_factory):
    """Answer and folder of the campaign, in one process."""
    folder = tmp_path_factory.mktemp("campaign") / "serial"
    return campaign(described, folder, command="toy"), folder
