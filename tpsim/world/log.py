"""What a roll-out records: samples kept as they come, made into signals all at once."""

import copy
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from tpsim import rotation
from tpsim.robot.along import jacobians_along, poses_along
from tpsim.robot.state import State
from tpsim.world.episode import BoundPerson, Episode
from tpsim.world.guard import unguarded
from tpsim.world.impedance import Impedance, hand_stiffness
from tpsim.world.tank import Energies
from tpsim.world.trial import Channels

EDGE = 1e-9
"""Angle [rad] from where joints are guarded within which a reference is held at their limits."""

_ALONE = ("saturated_steps", "contact_steps", "torque")
"""Samples that no person has a part in."""


class Log:
    """Samples of one roll-out.

    Parameters
    ----------
    episode : Episode
    sites : mapping of str to str
        Sites to record, by the name that the recording gives them; stiffness is recorded of
        those that are hands of the robot.
    """

    def __init__(self, episode: Episode, sites: Mapping[str, str]):
        self._robot, self._episode = episode.simulation.robot, episode
        self._sites, self._hands = dict(sites), set(self._robot.hands.values())
        for site in self._sites.values():
            self._robot.chain(site)  # which says what there is
        self._commands: list[Impedance | None] = []
        self._states: list[State] = []
        self._energies: list[Energies] = []
        self._samples: dict[object, list[np.ndarray | int]] = defaultdict(list)
        self._watched: Sequence[BoundPerson] = ()

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self._states)

    def add(self, torque: np.ndarray, command: Impedance | np.ndarray, energies: Energies) -> None:
        """Keep one sample."""
        episode, keep = self._episode, self._samples
        keep["saturated_steps"].append(episode.saturated)
        keep["contact_steps"].append(episode.contacts)
        keep["torque"].append(torque)
        for person in episode.people:
            for part, now in (("wrench", person.wrench), ("point", person.point)):
                row = keep[person, part]
                # Who comes later was not there before.
                if (missing := len(self._states) - len(row)) > 0:
                    row.extend([np.zeros_like(now)] * missing)
                row.append(now)
        for person in self._watched:
            keep[person, "point"].append(person.point)
        self._states.append(episode.truth)
        self._energies.append(energies)
        self._commands.append(command if isinstance(command, Impedance) else None)

    def watch(self, people: Sequence[BoundPerson]) -> None:
        """Keep where people would act who do nothing yet."""
        self._watched = people

    def fork(self, episode: Episode, which: int, person: BoundPerson) -> "Log":
        """The same samples, for an episode in which one who was watched acts from now on."""
        other, watched = copy.copy(self), self._watched[which]
        other._episode, other._watched = episode, ()
        for name in ("_commands", "_states", "_energies"):
            setattr(other, name, list(getattr(self, name)))
        alone: dict[object, list] = {
            name: list(kept) for name, kept in self._samples.items() if name in _ALONE
        }
        other._samples = defaultdict(list, alone)
        other._samples[person, "point"] = list(self._samples[watched, "point"])
        other._samples[person, "wrench"] = [np.zeros(6)] * len(self)
        return other

    @property
    def channels(self) -> Channels:
        """Names behind the signals."""
        people = dict.fromkeys(["push", *(person.name for person in self._episode.people)])
        hands = [name for name, site in self._sites.items() if site in self._hands]
        return Channels(
            tuple(self._sites),
            tuple(hands) if self._commanded else (),
            tuple(self._episode.objects_seen),
            tuple(people),
        )

    @property
    def _commanded(self) -> bool:
        """Whether the robot was driven by an impedance, not by torques alone."""
        return bool(self._commands) and all(command is not None for command in self._commands)

    def arrays(self) -> dict[str, np.ndarray]:
        """Signals (T, ...) by name."""
        states, robot = self._states, self._robot
        x = np.array([state.x for state in states])
        signals = {"time": np.array([state.time for state in states])}
        signals["q"], signals["dq"] = np.split(x, 2, axis=1)
        for name in ("torque", "saturated_steps", "contact_steps"):
            signals[name] = np.array(self._samples[name])
        bias = np.array([state.bias for state in states])
        signals["torque_feedforward"] = bias + robot.damping * signals["dq"]
        if self._commanded:
            signals |= self._impedance(signals["q"])
        signals |= self._wrenches()
        poses = poses_along(robot, signals["q"], self._sites.values())
        for name, R, p in zip(self._sites, poses.rotation, poses.position, strict=True):
            signals[f"{name}_position"] = p.copy()
            signals[f"{name}_quaternion"] = rotation.continuous(rotation.to_quaternion(R))
        for name, row in self._episode.objects_seen.items():
            signals[f"{name}_position"] = np.array([s.objects.positions[row] for s in states])
            signals[f"{name}_quaternion"] = np.array([s.objects.quaternions[row] for s in states])
        return signals

    def _impedance(self, q: np.ndarray) -> dict[str, np.ndarray]:
        robot, commands = self._robot, [c for c in self._commands if c is not None]
        stiffness, damping, reference = (
            np.array([getattr(command, part) for command in commands])
            for part in ("stiffness", "damping", "reference")
        )
        lower, upper = unguarded(robot)
        signals = {
            "stiffness": np.einsum("tii->ti", stiffness),
            "damping": np.einsum("tii->ti", damping),
            "reference": reference,
            # What asks for all that the joints can do, or more, is out of reach.
            "beyond_limits": (reference < lower + EDGE) | (reference > upper - EDGE),
        }
        for name, energy in zip(Energies._fields, np.array(self._energies).T, strict=True):
            # A tank without limit has no level.
            if np.isfinite(energy).all():
                signals[f"energy_{name}"] = energy
        hands = {name: site for name, site in self._sites.items() if site in self._hands}
        for name, J in zip(hands, jacobians_along(robot, q, hands.values()), strict=True):
            signals[f"{name}_stiffness"] = hand_stiffness(J, stiffness)[:, :3, :3]
        return signals

    def _wrenches(self) -> dict[str, np.ndarray]:
        """Wrenches by the names of people, those of one name added up, and where they act."""
        samples = len(self._states)
        signals = {"push_wrench": np.zeros((samples, 6)), "push_point": np.zeros((samples, 3))}
        for person in self._episode.people:
            if not self._samples[person, "wrench"]:
                continue  # came after the last sample
            wrench, point = f"{person.name}_wrench", f"{person.name}_point"
            acts, at = (np.array(self._samples[person, part]) for part in ("wrench", "point"))
            busy = acts.any(axis=1, keepdims=True)
            signals[point] = np.where(busy, at, signals.get(point, at))
            signals[wrench] = signals.get(wrench, np.zeros((samples, 6))) + acts
        return signals
