"""One trial: what happened on the robot, by name and on one clock."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from tpsim.border import border, read
from tpsim.checks import instance, shown
from tpsim.errors import ArgumentError
from tpsim.pose import Pose


@dataclass(frozen=True)
class Channels:
    """What a trial recorded, besides the joints: the names behind its signals.

    Parameters
    ----------
    sites : tuple of str
        ``<site>_position`` (T, 3) m and ``<site>_quaternion`` (T, 4).
    hands : tuple of str
        Those sites for which there is ``<hand>_stiffness`` (T, 3, 3) N/m, too.
    objects : tuple of str
        ``<object>_position`` and ``<object>_quaternion``.
    people : tuple of str
        ``<person>_wrench`` (T, 6) N, Nm and ``<person>_point`` (T, 3) m, where it acts.
    """

    sites: tuple[str, ...] = ()
    hands: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()
    people: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Trial:
    """What one simulated trial left behind.

    Parameters
    ----------
    arrays : dict of str to ndarray
        Signals sampled at 100 Hz: ``time (T,)`` s, ``q (T, n)`` rad, ``dq (T, n)`` rad/s,
        ``torque (T, n)`` Nm, and those that ``channels`` names; under impedances
        ``energy_stored``, ``energy_dissipated``, ``energy_injected`` and ``energy_tank (T,)`` J,
        see :class:`tpsim.world.tank.Energies`.
    outcome : str
        ``"done"``, or why it ended or does not count: ``"diverged"``, ``"contact"``,
        ``"joint limit"``, ``"saturated"``, ``"unseen: cup"``. A failure is data here, not an
        exception.
    channels : Channels
    about : dict
        What is needed to run it again, as plain JSON values.
    touched : str
        The first two bodies that touched, where something did; recordings do not keep it.
    """

    arrays: Mapping[str, np.ndarray]
    outcome: str = "done"
    channels: Channels = Channels()
    about: Mapping[str, object] = field(default_factory=dict)
    touched: str = ""

    def __post_init__(self) -> None:
        for name in ("outcome", "touched"):
            read(name, getattr(self, name), str)
        instance("channels", self.channels, Channels)
        for name in ("arrays", "about"):
            read(name, getattr(self, name), Mapping)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the signal called ``name``."""
        if not isinstance(name, str) or name not in self.arrays:
            raise ArgumentError(
                f"the trial has no signal {shown(name)}; it has {', '.join(sorted(self.arrays))}"
            )
        return self.arrays[name]

    @property
    def time(self) -> np.ndarray:
        """Time (T,) [s]."""
        return self["time"]

    @border
    def pose(self, name: str) -> Pose:
        """Poses (T,) of a recorded site or object in the world."""
        return Pose.of_quaternion(self[f"{name}_position"], self[f"{name}_quaternion"])

    @property
    def objects(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Positions (T, 3) [m] and quaternions (T, 4) of the recorded objects."""
        return {
            name: (self[f"{name}_position"], self[f"{name}_quaternion"])
            for name in self.channels.objects
        }

    @border
    def with_about(self, outcome: str | None = None, **about: object) -> "Trial":
        """The same trial, saying more about itself."""
        return replace(self, outcome=outcome or self.outcome, about={**self.about, **about})
