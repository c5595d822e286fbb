"""Carry from one dock into another along a learned approach (U-shaped frames of Figs 1, 2, 12).

Every dock sees the gripper's position and orientation over time (Eq. 20), each as a frame of its
own; the arm's posture is one more frame. What a frame saw consistently is precise there: near the
docks the way of leaving and entering them. The movement is retrieved by GMR in each frame, and
tracked by the LQT of all frames at once over the finite horizon (Eq. 38), wherever the docks go.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import ClassVar

import numpy as np
import pinocchio as pin

from tpsim import rotation
from tpsim.control.poses import SeenMovement
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.dtw import align
from tpsim.learning.gmm import GMM
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.pose import coordinates, object_frame
from tpsim.retrieval.gmr import gmr
from tpsim.sim import scene
from tpsim.sim.controllers.finite_horizon import FiniteHorizon
from tpsim.sim.coordinates.coordinate import Coordinate, HandPose, Posture
from tpsim.sim.simulation import Simulation
from tpsim.sim.teach import Lesson, demonstrate
from tpsim.sim.trial import Trial
from tpsim.tasks import docks
from tpsim.tasks.task import Situation, Task

MOVEMENT = sum(docks.SECONDS) / 2 + 2 * docks.REST
"""Time of the movement [s], as it was taught on average; its end then lasts."""

SAMPLES = 150
"""Samples of a demonstration from which the model is learned."""

WARP = 0.1
"""Share of the movement by which demonstrations may be out of step before they are aligned."""

DT = 0.03
"""Time step of the plan [s]."""

EFFORT = 0.05
"""Cost of torque [1/(Nm)^2]: the one number that sets how soft the arm is."""

ARRIVED = {"position": 0.005, "orientation": float(np.radians(3.0))}
"""Distance [m] and angle [rad] from the place in the second dock at which the hand is there."""

MISSED = 10.0
"""How many times farther than that the hand counts as unable to reach it."""

PARTS = {"position": slice(0, 3), "orientation": slice(3, 6)}
"""Of a pose. Apart, since a few demonstrations do not show how they depend on each other."""


@dataclass(frozen=True)
class View(Coordinate):
    """A part of the hand's pose as a dock sees it, Eq. (41): d = 3.

    Parameters
    ----------
    dock, part : str
        One of ``docks.NAMES`` and of ``PARTS``.
    """

    dock: str
    part: str

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return HandPose.labels[PARTS[self.part]]

    def bind(self, robot):
        """Return a function that gives y (3,) and J (3, n) of the robot's last update."""
        hand, part = robot.site(docks.GRIPPER), PARTS[self.part]
        (p_dock, turned), reference = robot.objects[self.dock], docks.HELD[self.dock].T

        def evaluate():
            R, p = robot.placement(hand)
            back = pin.Quaternion(*turned.tolist()).matrix().T
            J = back @ robot.jacobian(hand)[part]
            if self.part == "position":
                return back @ (p - p_dock), J
            error = back @ R @ reference
            return pin.log3(error), pin.Jlog3(error).T @ J

        return evaluate


class Transfer(Task):
    """Carry a sugar cube from the first dock into the second, on Baxter's left arm."""

    name = "transfer"
    behaviours = ("transfer",)
    sites: ClassVar = {"left_hand": docks.GRIPPER, "left_elbow": "left_elbow"}
    duration = MOVEMENT + 1.5
    demonstrations, components = 12, 10

    def simulation(self, xml: str | None = None) -> Simulation:
        """Baxter with a sugar cube in its left hand, and two docks."""
        if xml is None:
            xml = scene.baxter(dict.fromkeys(docks.NAMES, "dock"), held="sugar")
        return Simulation(xml)

    def lesson(self, simulation: Simulation, behaviour: str, rng) -> Lesson:
        """Draw docks within the taught range, and how a person carries between them."""
        placed = docks.draw(rng)
        return _lesson(simulation, placed, docks.start_posture(simulation, placed, rng), rng)

    def coordinates(self, simulation: Simulation, behaviour: str) -> tuple[Coordinate, ...]:
        """What the frames observe: position and orientation from each dock, and the posture."""
        views = (View(f"{part} from {name}", name, part) for name in docks.NAMES for part in PARTS)
        return *views, Posture("posture", _arm(simulation, "left"))

    def learn(
        self, simulation: Simulation, behaviour: str, trials: Sequence[Trial], components: int
    ) -> TPGMM:
        """Fit a TP-GMM over time and all frames to the demonstrations, brought onto one time."""
        arm = [joint in _arm(simulation, "left") for joint in simulation.robot.joints]
        views = [_demonstration(trial, arm).resampled(SAMPLES) for trial in trials]
        clock = np.linspace(0.0, MOVEMENT, SAMPLES)
        aligned = align(views, by="frames", band=WARP * SAMPLES)
        return fit_tp_gmm([view.with_time(clock) for view in aligned], components, start="time")

    def draw(self, simulation: Simulation, rng, far: bool = False) -> tuple[np.ndarray, dict]:
        """Draw docks, and a posture with the hand in the first one."""
        placed = docks.draw(rng, far)
        start = docks.start_posture(simulation, placed, rng)
        return start, {"objects": [asdict(path) for path in docks.at_rest(placed)]}

    def controller(
        self, simulation: Simulation, models: Mapping[str, TPGMM], start, kind: str = "learned"
    ) -> FiniteHorizon:
        """GMR over time in every frame, then LQT of all of them."""
        if kind != "learned":
            raise ArgumentError(
                f"there is no controller '{kind}' for transfer; use 'learned' or 'teacher'"
            )
        (name,) = self.behaviours
        return _controller(simulation, models[name])

    def perform(
        self,
        simulation: Simulation,
        models: Mapping[str, TPGMM],
        situation: Situation,
        *,
        controller: str = "learned",
        people: Sequence = (),
        duration: float | None = None,
    ) -> Trial:
        """Carry from dock to dock wherever they move; ``"teacher"`` shows how it would be taught.

        The outcome is ``"unreachable"`` where the hand ends far from the second dock.
        """
        if controller == "teacher":
            key = np.random.SeedSequence(situation.seed, spawn_key=(2, situation.index))
            placed = docks.at_start(self.objects(situation))
            lesson = _lesson(
                simulation, placed, np.array(situation.start), np.random.default_rng(key)
            )
            return demonstrate(simulation, lesson, self.sites)
        trial = super().perform(
            simulation, models, situation, controller=controller, people=people, duration=duration
        )
        return Trial(trial.arrays, _outcome(trial), trial.about)

    def errors(self, simulation: Simulation):
        """Distance [m] and angle [rad] of the hand from its place in the second dock."""
        views = [View(part, "end", part).bind(simulation.robot) for part in PARTS]
        return lambda: {
            part: (float(np.linalg.norm(view()[0])), enough)
            for (part, enough), view in zip(ARRIVED.items(), views, strict=True)
        }


def end_error(trial: Trial) -> tuple[np.ndarray, np.ndarray]:
    """Distance (T,) [m] and angle (T,) [rad] of the hand from its place in the second dock."""
    pose = _hand(trial)
    p, w = np.split(coordinates(pose, docks.HELD["end"], seen_from=_dock(trial, "end")), 2, axis=-1)
    return np.linalg.norm(p, axis=-1), np.linalg.norm(w, axis=-1)


def _lesson(simulation, placed, start, rng) -> Lesson:
    seconds = rng.uniform(*docks.SECONDS)
    guide = docks.guide(simulation, placed, seconds, rng)
    held = _arm(simulation, "right")
    return Lesson(start, (guide,), seconds + 2 * docks.REST, held, docks.at_rest(placed))


def _arm(simulation, side) -> tuple[str, ...]:
    return tuple(joint for joint in simulation.robot.joints if joint.startswith(side))


def _hand(trial):
    return rotation.from_quaternion(trial["left_hand_quaternion"]), trial["left_hand_position"]


def _dock(trial, name):
    return rotation.from_quaternion(trial[f"{name}_quaternion"]), trial[f"{name}_position"]


def _demonstration(trial: Trial, arm: Sequence[bool]) -> Demonstration:
    """One taught trial as both docks and the arm's posture see it.

    Common coordinates are the hand's pose, in a chart about its place in the second dock, and
    the arm's posture; every frame sees a part of them.
    """
    hand, posture = _hand(trial), trial["q"][:, arm]
    common = _dock(trial, "end")[0][-1] @ docks.HELD["end"]
    pose = coordinates(hand, common)
    T, size = len(pose), pose.shape[1] + posture.shape[1]
    frames, views = [], []
    for name in docks.NAMES:
        dock = _dock(trial, name)
        affine = object_frame(dock, docks.HELD[name], common, pose)
        seen = coordinates(hand, docks.HELD[name], dock)
        for part in PARTS.values():
            A, b = np.zeros((T, size, 3)), np.zeros((T, size))
            A[:, part], b[:, part] = affine.A[:, part, part], affine.b[:, part]
            frames.append(Frame(A, b))
            views.append(seen[:, part])
    frames.append(Frame(np.eye(size)[:, pose.shape[1] :], np.zeros(size)))
    return Demonstration(trial["time"], np.hstack([pose, posture]), frames, [*views, posture])


def _controller(simulation: Simulation, model: TPGMM) -> FiniteHorizon:
    """The learned controller: GMR over time in every frame, then LQT of all of them."""
    times = np.linspace(0.0, MOVEMENT, round(MOVEMENT / DT) + 1)
    *seen, posture = (gmr(GMM(model.priors, frame), times) for frame in model.frames)
    movements = []
    for name, *parts in zip(docks.NAMES, seen[::2], seen[1::2], strict=True):
        precision = np.zeros((len(times), 6, 6))
        for part, gaussian in zip(PARTS.values(), parts, strict=True):
            precision[:, part, part] = gaussian.precision
        mean = np.hstack([gaussian.mean for gaussian in parts])
        movements.append(SeenMovement(mean, precision, docks.HELD[name]))
    return FiniteHorizon(
        simulation,
        docks.NAMES,
        movements,
        # Too few demonstrations to tell how seven joints depend on each other.
        Gaussian(posture.mean, posture.covariance * np.eye(posture.dim)),
        joints=_arm(simulation, "left"),
        site=docks.GRIPPER,
        dt=DT,
        effort=EFFORT,
    )


def _outcome(trial: Trial) -> str:
    errors = zip(end_error(trial), ARRIVED.values(), strict=True)
    missed = any(error[-1] > MISSED * enough for error, enough in errors)
    missed &= trial.outcome != "diverged"
    return "unreachable" if missed else trial.outcome


def task(name: str) -> Transfer:
    """The task called ``transfer``."""
    return Transfer()
