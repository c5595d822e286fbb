"""Roll-outs: a controller drives the robot at 1 kHz, people push and lead it, all is recorded."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from tpsim import rotation
from tpsim.errors import ArgumentError
from tpsim.sim.controllers.controller import Controller, hand_stiffness
from tpsim.sim.hand import Guide
from tpsim.sim.objects import ObjectPath
from tpsim.sim.push import Push
from tpsim.sim.simulation import Simulation
from tpsim.sim.surroundings import Surroundings
from tpsim.sim.trial import Trial

RECORD_PERIOD = 0.01
"""Time [s] between samples of a recording."""


def rollout(
    simulation: Simulation,
    controller: Controller,
    start,
    duration: float,
    *,
    sites: Mapping[str, str],
    people: Sequence[Push | Guide] = (),
    objects: Sequence[ObjectPath] = (),
    about: dict | None = None,
) -> Trial:
    """Let a controller drive the robot from rest for a while, and record it.

    Parameters
    ----------
    simulation : Simulation
    controller : Controller
        Bound to ``simulation.robot``.
    start : (n,)
        Start posture [rad].
    duration : float
        Time [s].
    sites : mapping
        Sites to record, by the name that the recording gives them.
    people : sequence of Push or Guide
        Who pushes and leads the robot meanwhile.
    objects : sequence of ObjectPath
        Where movable objects are; those without a path stay where the scene has them. The
        recording keeps ``<object>_position (T, 3)`` and ``<object>_quaternion (T, 4)`` of all.
    about : dict, optional
        Kept in the trial.

    Returns
    -------
    Trial
        At 100 Hz; ``outcome`` is ``"diverged"`` where the state became wild, ``"contact"`` where
        something touched, else ``"done"``.
    """
    if not (np.isfinite(duration) and duration > 0):
        raise ArgumentError(f"duration is {duration} s; give a positive number")
    steps, stride = (max(1, round(t / simulation.timestep)) for t in (duration, RECORD_PERIOD))
    surroundings = Surroundings(simulation, people, objects)
    log = _Log(simulation, sites, surroundings)
    surroundings.reset(start)
    outcome = "done"
    for step in range(steps):
        surroundings.sense()
        torque = surroundings.act(controller.torque())
        if step % stride == 0:
            if surroundings.diverged:
                outcome = "diverged"
                break
            log.add(torque, controller)
        surroundings.advance(torque)
    if surroundings.contacts and outcome == "done":
        outcome = "contact"
    return Trial(log.arrays(), outcome, about or {})


class _Log:
    """Samples of one roll-out: kept as they come, and made into signals all at once."""

    def __init__(self, simulation, sites, surroundings):
        self._simulation, self._surroundings = simulation, surroundings
        self._sites = {name: simulation.robot.site(site) for name, site in sites.items()}
        self._samples = defaultdict(list)

    def add(self, torque, controller):
        robot, surroundings, keep = self._simulation.robot, self._surroundings, self._samples
        keep["time"].append(self._simulation.time)
        keep["saturated_steps"].append(surroundings.saturated)
        keep["contact_steps"].append(surroundings.contacts)
        keep["state"].append(robot.state)
        keep["torque"].append(torque)
        keep["torque_feedforward"].append(controller.feedforward)
        keep["impedance"].append(controller.impedance())
        for person in surroundings.people:
            keep[person, "wrench"].append(person.wrench)
            keep[person, "point"].append(person.point)
        for name, site in self._sites.items():
            R, p = robot.placement(site)
            keep[name, "rotation"].append(R.copy())
            keep[name, "position"].append(p.copy())
            keep[name, "jacobian"].append(robot.jacobian(site))
        for name, (position, quaternion) in self._simulation.objects.items():
            keep[name, "position"].append(position.copy())
            keep[name, "quaternion"].append(quaternion.copy())

    def arrays(self) -> dict[str, np.ndarray]:
        """Signals (T, ...) by name."""
        robot, keep = self._simulation.robot, self._samples
        counted = "time", "saturated_steps", "contact_steps", "torque", "torque_feedforward"
        signals = {name: np.array(keep[name]) for name in counted}
        signals["q"], signals["dq"] = np.split(np.array(keep["state"]), 2, axis=1)
        stiffness, damping, reference = (
            np.array([getattr(impedance, part) for impedance in keep["impedance"]])
            for part in ("stiffness", "damping", "reference")
        )
        signals["stiffness"] = np.einsum("tii->ti", stiffness)
        signals["damping"] = np.einsum("tii->ti", damping)
        signals["reference"] = reference
        # What asks for more than the joints can do is out of reach.
        signals["beyond_limits"] = (reference < robot.lower) | (reference > robot.upper)
        signals |= self._pushed(len(reference))
        for name in self._sites:
            turned = rotation.to_quaternion(np.array(keep[name, "rotation"]))
            signals[f"{name}_position"] = np.array(keep[name, "position"])
            signals[f"{name}_quaternion"] = rotation.continuous(turned)
            if name.endswith("hand"):
                felt = hand_stiffness(keep[name, "jacobian"], stiffness)
                signals[f"{name}_stiffness"] = felt[:, :3, :3]
        for name in self._simulation.objects:
            for part in ("position", "quaternion"):
                signals[f"{name}_{part}"] = np.array(keep[name, part])
        return signals

    def _pushed(self, samples):
        """Wrenches by the names of people, those of one name added up, and where they act."""
        signals = {"push_wrench": np.zeros((samples, 6)), "push_point": np.zeros((samples, 3))}
        for person in self._surroundings.people:
            wrench, point = f"{person.name}_wrench", f"{person.name}_point"
            acts, at = (np.array(self._samples[person, part]) for part in ("wrench", "point"))
            busy = acts.any(axis=1, keepdims=True)
            signals[point] = np.where(busy, at, signals.get(point, at))
            signals[wrench] = signals.get(wrench, 0.0) + acts
        return signals
