"""Roll-outs: a controller drives the robot at 1 kHz, people push and lead it, all is recorded."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpsim import rotation
from tpsim.errors import ArgumentError
from tpsim.sim.controller import Controller, hand_stiffness
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
    """Samples of one roll-out."""

    def __init__(self, simulation, sites, surroundings):
        self._simulation, self._surroundings = simulation, surroundings
        self._sites = {name: simulation.robot.site(site) for name, site in sites.items()}
        self._rows = []

    def add(self, torque, controller):
        robot, surroundings = self._simulation.robot, self._surroundings
        impedance = controller.impedance()
        reference = impedance.reference
        row = {
            "time": self._simulation.time,
            "q": robot.q,
            "dq": robot.dq,
            "torque": torque,
            "torque_feedforward": controller.feedforward,
            "reference": reference,
            # What asks for more than the joints can do is out of reach.
            "beyond_limits": (reference < robot.lower) | (reference > robot.upper),
            "stiffness": np.diagonal(impedance.stiffness),
            "damping": np.diagonal(impedance.damping),
            "saturated_steps": surroundings.saturated,
            "contact_steps": surroundings.contacts,
            "push_wrench": np.zeros(6),
            "push_point": np.zeros(3),
        }
        for person in surroundings.people:
            wrench, point = f"{person.name}_wrench", f"{person.name}_point"
            if person.wrench.any() or wrench not in row:
                row[point] = person.point
            row[wrench] = row.get(wrench, 0.0) + person.wrench
        for name, site in self._sites.items():
            R, p = robot.placement(site)
            row[f"{name}_position"], row[f"{name}_quaternion"] = p.copy(), R.copy()
            if name.endswith("hand"):
                stiffness = hand_stiffness(robot, impedance.stiffness, site)
                row[f"{name}_stiffness"] = stiffness[:3, :3]
        for name, (position, quaternion) in self._simulation.objects.items():
            row[f"{name}_position"] = position.copy()
            row[f"{name}_quaternion"] = quaternion.copy()
        self._rows.append(row)

    def arrays(self):
        arrays = {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}
        for name in self._sites:
            quaternions = rotation.to_quaternion(arrays[f"{name}_quaternion"])
            arrays[f"{name}_quaternion"] = rotation.continuous(quaternions)
        return arrays
