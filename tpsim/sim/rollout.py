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
from tpsim.sim.trial import Trial

RECORD_PERIOD = 0.01
"""Time [s] between samples of a recording."""

DIVERGED_SPEED = 30.0
"""Joint speed [rad/s] beyond which a trial is given up as diverged."""


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
    robot, h = simulation.robot, simulation.timestep
    steps, stride = round(duration / h), max(1, round(RECORD_PERIOD / h))
    outside = [person.bind(simulation) for person in people]
    movers = [path.bind(simulation) for path in objects]
    log = _Log(simulation, sites)
    simulation.reset(start)
    saturated = contacts = 0
    outcome = "done"
    limit = robot.torque_limit
    for step in range(steps):
        for mover in movers:
            mover.act(step)
        robot.update(simulation.q.copy(), simulation.dq.copy())
        wanted = controller.torque()
        torque = np.minimum(np.maximum(wanted, -limit), limit)
        saturated += (torque != wanted).any()
        simulation.clear_wrenches()
        for person in outside:
            person.act(step)
        if step % stride == 0:
            # MuJoCo starts over where the state is lost: its clock then disagrees with ours.
            if not np.abs(robot.dq).max() < DIVERGED_SPEED or simulation.time < (step - 1) * h:
                outcome = "diverged"
                break
            log.add(torque, controller, outside, saturated, contacts)
        simulation.step(torque)
        contacts += simulation.data.ncon > 0
    if contacts and outcome == "done":
        outcome = "contact"
    return Trial(log.arrays(), outcome, about or {})


class _Log:
    """Samples of one roll-out."""

    def __init__(self, simulation, sites):
        self._simulation = simulation
        self._sites = {name: simulation.robot.site(site) for name, site in sites.items()}
        self._rows = []

    def add(self, torque, controller, outside, saturated, contacts):
        robot = self._simulation.robot
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
            "saturated_steps": saturated,
            "contact_steps": contacts,
            "push_wrench": np.zeros(6),
            "push_point": np.zeros(3),
        }
        for person in outside:
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
