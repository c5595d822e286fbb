"""The built-in tasks under ids of Gymnasium; importing this module registers them.

``tpsim/CupAndSugar-v0``, ``tpsim/Pointing-v0`` and so on, one for each of
:data:`tpsim.tasks.STUDIES`:

>>> import gymnasium
>>> import tpsim.tasks.gymnasium
>>> env = gymnasium.make("tpsim/Pointing-v0", action="impedance", control_timestep=0.02)
>>> observation, info = env.reset(seed=0)
>>> observation["q"].shape
(3,)
"""

import gymnasium

from tpsim.study.reference import load_study
from tpsim.task.gymnasium import TaskEnvironment, gym_environment
from tpsim.tasks import STUDIES

IDS = {f"tpsim/{name.title().replace('-', '')}-v0": name for name in STUDIES}
"""Names of the built-in studies by their ids."""


def make(study: str, **options) -> TaskEnvironment:  # type: ignore[no-untyped-def]
    """Make the environment of a built-in task.

    Parameters
    ----------
    study : str
        One of :data:`tpsim.tasks.STUDIES`.
    **options
        As :func:`tpsim.task.gymnasium.gym_environment` takes them.
    """
    return gym_environment(load_study(study, STUDIES).task, **options)


for _id, _name in IDS.items():
    if _id not in gymnasium.registry:
        gymnasium.register(_id, f"{__name__}:make", kwargs={"study": _name})
