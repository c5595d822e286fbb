"""Conditions: what is varied from trial to trial, and the pool of processes that performs them."""

import multiprocessing
import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass

from tpsim import tasks
from tpsim.learning.tp_gmm import TPGMM
from tpsim.sim.hand import Guide, Hand
from tpsim.sim.push import Push
from tpsim.sim.script import straight
from tpsim.sim.simulation import Simulation
from tpsim.sim.trial import Trial
from tpsim.tasks.task import Situation, Task


@dataclass(frozen=True)
class Lead:
    """A person leads a site along a straight line, and feels what resists.

    Parameters
    ----------
    site : str
    origin : (3,) tuple
        Where the site is when the person takes hold [m].
    travel : (3,) tuple
        How far it is led [m].
    start, duration, rest : float
        When it begins, how long it takes, how long the person then stays there [s].
    stiffness : float
        Of the person's grip [N/m].
    max_force : float
        Strength of the person [N].
    """

    site: str
    origin: tuple[float, float, float]
    travel: tuple[float, float, float]
    start: float = 1.5
    duration: float = 3.0
    rest: float = 0.5
    stiffness: float = 2000.0
    max_force: float = 60.0

    def guide(self, timestep: float) -> Guide:
        """The hand that does it."""
        damping = 2 * self.stiffness**0.5
        hand = Hand(self.stiffness, damping, 0.0, 0.0, self.max_force)
        path = straight(self.origin, self.travel, self.duration, self.rest, timestep)
        return Guide("lead", self.site, hand, path, start=self.start)


@dataclass(frozen=True)
class Condition:
    """One trial to perform.

    Parameters
    ----------
    label : str
        Group of conditions that it belongs to, such as ``"pushed"``.
    situation : Situation
    controller : str
        ``"learned"``, or one of those to compare with.
    push : Push, optional
    lead : Lead, optional
    duration : float, optional
        Of the trial [s]; the task's own by default.
    """

    label: str
    situation: Situation
    controller: str = "learned"
    push: Push | None = None
    lead: Lead | None = None
    duration: float | None = None

    def perform(self, task: Task, simulation: Simulation, models: Mapping[str, TPGMM]) -> Trial:
        """Perform it; ``about`` of the trial says how to do so again."""
        people = [] if self.push is None else [self.push]
        if self.lead is not None:
            people.append(self.lead.guide(simulation.timestep))
        trial = task.perform(
            simulation,
            models,
            self.situation,
            controller=self.controller,
            people=people,
            duration=self.duration,
        )
        return Trial(trial.arrays, trial.outcome, {"task": task.name, "condition": asdict(self)})

    @classmethod
    def from_about(cls, about: dict) -> "Condition":
        """The condition of a recorded trial."""
        given = dict(about["condition"])
        situation = dict(given.pop("situation"))
        push, lead = given.pop("push"), given.pop("lead")
        return cls(
            situation=Situation(**{**situation, "start": tuple(situation["start"])}),
            push=None if push is None else Push(**_tuples(push)),
            lead=None if lead is None else Lead(**_tuples(lead)),
            **given,
        )


def _tuples(fields: dict) -> dict:
    """JSON's lists as the tuples they were."""
    return {k: tuple(v) if isinstance(v, list) else v for k, v in fields.items()}


def perform(
    conditions: Sequence[Condition],
    task: str,
    xml: str,
    models: Mapping[str, TPGMM],
    workers: int,
) -> Iterator[Trial]:
    """Perform conditions in processes of their own; trials come in the order of conditions.

    Each trial starts from its condition alone, so the number of workers changes no bit.
    """
    if workers == 1 or len(conditions) == 1:
        bench = _open(task, xml, models)
        yield from (condition.perform(*bench) for condition in conditions)
        return
    # Fresh processes inherit no threads, locks or renderers.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, _start, (task, xml, dict(models))) as pool:
        try:
            yield from pool.map(_perform, conditions)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


_bench: tuple[Task, Simulation, Mapping[str, TPGMM]] | None = None


def _open(task, xml, models):
    task = tasks.load(task)
    return task, task.simulation(xml), models


def _start(task, xml, models):
    global _bench
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    _bench = _open(task, xml, models)


def _perform(condition: Condition) -> Trial:
    return condition.perform(*_bench)
