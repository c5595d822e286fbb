"""What is done with a task: teach, learn, perform."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from tpsim.border import Count, Duration, SeedNumber, border
from tpsim.checks import choice
from tpsim.errors import ArgumentError
from tpsim.learning.tp_gmm import TPGMM
from tpsim.task.acceptance import refusal
from tpsim.task.check import check
from tpsim.task.relevance import with_relevance
from tpsim.task.task import Models, Situation, Task, controller_of, demonstration
from tpsim.world.course import Course, Shown
from tpsim.world.episode import Person
from tpsim.world.impedance import Controller
from tpsim.world.people.push import Push
from tpsim.world.plant import NOMINAL, Plant
from tpsim.world.rollout import Rollout, rollout
from tpsim.world.tank import Tank
from tpsim.world.teaching import Attempt, attempted
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial

Taught = Mapping[str, Sequence[Trial]]
"""Demonstrations of every behaviour, by name."""


@one_thread()
@border
def teach(
    task: Task,
    count: Count | None = None,
    seed: SeedNumber = 0,
    behaviours: Sequence[str] | None = None,
    progress: Callable[[str, int, str], None] | None = None,
) -> dict[str, list[Trial]]:
    """Teach the behaviours of a task on the weightless robot.

    Demonstrations that miss a behaviour's goals are refused and shown again, as are those in
    which something went wrong.

    Parameters
    ----------
    task : Task
    count : int, optional
        Good demonstrations of each behaviour; as many as the task asks for by default.
    seed : int
    behaviours : sequence of str, optional
        All by default.
    progress : callable, optional
        Told behaviour, attempt and how it ended: ``"done"``, or why it was refused.

    Raises
    ------
    SimulationError
        If too many demonstrations are useless.
    """
    shown = show_all(task, count, seed, behaviours, progress)
    return {name: list(found.trials) for name, found in shown.items()}


def show_all(
    task: Task,
    count: int | None = None,
    seed: int = 0,
    behaviours: Sequence[str] | None = None,
    progress: Callable[[str, int, str], None] | None = None,
) -> dict[str, Shown]:
    """As :func:`teach`, with how many attempts were refused, and why."""
    check(task)
    wanted = list(task.behaviours()) if behaviours is None else behaviours
    for name in wanted:
        choice("behaviours", name, task.behaviours())
    taught = {}
    for name in wanted:
        course = Course(
            task.demonstrations if count is None else count,
            None if progress is None else _telling(progress, name),
        )
        while attempts := course.wanted:
            course.add(show_once(task, name, attempts[0], seed))
        taught[name] = course.shown
    return taught


def show_once(task: Task, behaviour: str, attempt: int, seed: int = 0) -> Attempt:
    """One attempt at a behaviour, refused where it misses the behaviour's goals."""
    shown = task.behaviours()[behaviour]
    trial, why = attempted(
        task.stage,
        shown.teacher,
        attempt,
        seed=seed,
        sites=task.sites(),
        judge=partial(refusal, task.stage.robot, goals=shown.goals),
    )
    return Attempt(None if trial is None else trial.with_about(behaviour=behaviour), why)


def _telling(progress: Callable[[str, int, str], None], name: str) -> Callable[[int, str], None]:
    return lambda attempt, outcome: progress(name, attempt, outcome)


@one_thread()
@border
def learn(task: Task, taught: Taught) -> dict[str, TPGMM]:
    """Learn every behaviour of a task from its demonstrations (Appendix A).

    Raises
    ------
    ArgumentError
        If a behaviour was not taught.
    """
    models = {}
    for name, behaviour in task.behaviours().items():
        if not taught.get(name):
            raise ArgumentError(f"there are no demonstrations of '{name}'; teach it first")
        seen = [
            demonstration(task.stage, trial, behaviour.views, behaviour.cutoff)
            for trial in taught[name]
        ]
        models[name] = behaviour.fit(seen)
    views = {name: behaviour.views for name, behaviour in task.behaviours().items()}
    return with_relevance(task.stage.robot, models, views, taught)


def perform_beside(
    task: Task,
    models: Models,
    situation: Situation,
    pushes: Sequence[Push],
    *,
    controller: Controller | None = None,
    duration: float | None = None,
    plant: Plant = NOMINAL,
) -> list[Trial]:
    """Perform a task once undisturbed, and once under each of some pushes.

    What comes before a push is performed once for all. The bits are those of :func:`perform`, as
    long as the controller holds all that it knows in itself.

    Returns
    -------
    list of Trial
        The undisturbed one first.
    """
    if controller is None:
        controller = controller_of(task, models, situation)
    h = task.stage.timestep
    end = max(1, round((task.duration if duration is None else duration) / h))
    going = Rollout(
        task.stage.simulation(plant),
        controller,
        situation.start,
        sites=task.sites(),
        objects=situation.objects,
        plant=plant,
    )
    going.watch(pushes)
    found: dict[int, Trial] = {}
    for which in sorted(range(len(pushes)), key=lambda k: pushes[k].start):
        # At this step the push does not act yet.
        going.run(min(int(pushes[which].start / h + 1e-9), end))
        found[which] = going.fork(which).run(end).trial()
    trials = [going.run(end).trial(), *(found[which] for which in range(len(pushes)))]
    return [trial.with_about(task.outcome(trial)) for trial in trials]


@one_thread()
@border
def perform(
    task: Task,
    models: Models,
    situation: Situation,
    *,
    controller: Controller | None = None,
    people: Sequence[Person] = (),
    duration: Duration | None = None,
    plant: Plant = NOMINAL,
    tank: Tank | None = None,
) -> Trial:
    """Perform a task once.

    Parameters
    ----------
    task : Task
    models : mapping of str to TPGMM
    situation : Situation
    controller : Controller, optional
        The task's own, of what was learned, by default.
    people : sequence of Person
        Who pushes and leads the robot.
    duration : float, optional
        [s]; the task's own by default.
    plant : Plant
        How the simulated robot differs from the controller's model.
    tank : Tank, optional
        What impedances may put into the robot; the robot's own by default.
    """
    if controller is None:
        controller = controller_of(task, models, situation)
    trial = rollout(
        task.stage,
        controller,
        situation.start,
        task.duration if duration is None else duration,
        sites=task.sites(),
        people=people,
        objects=situation.objects,
        plant=plant,
        tank=tank,
    )
    return trial.with_about(task.outcome(trial))
