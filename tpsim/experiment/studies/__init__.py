"""Studies: what is varied and measured in the experiments on each task."""

from importlib import import_module

from tpsim.experiment.studies.study import Study
from tpsim.tasks import load, room


def study(name: str) -> Study:
    """The :class:`~tpsim.experiment.studies.study.Study` of the task called ``name``."""
    return import_module(f"tpsim.experiment.studies.{room(name)}").study(load(name))
