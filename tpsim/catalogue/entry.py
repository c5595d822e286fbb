"""An entry of the catalogue: a robot by its name, made when it is asked for."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot


@dataclass(frozen=True)
class Entry:
    """A robot of the catalogue.

    Parameters
    ----------
    name : str
        What ``--robot`` takes.
    title : str
    licence : str
        Of its file.
    make : callable
        Takes the robot in.
    module, package : str
        What has to be installed: a module's name, and what pip calls it; nothing for our own.
    """

    name: str
    title: str
    licence: str
    make: Callable[[], Robot]
    module: str = ""
    package: str = ""

    @property
    def is_at_hand(self) -> bool:
        """Whether what it needs is installed."""
        return not self.module or find_spec(self.module) is not None

    def robot(self) -> Robot:
        """The robot.

        Raises
        ------
        ArgumentError
            If its package is missing, or the file cannot be taken in.
        """
        if not self.is_at_hand:
            raise ArgumentError(
                f"robot '{self.name}' is a model of {self.package}: pip install {self.package}"
            )
        return self.make()
