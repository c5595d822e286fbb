"""How the experts' gains are tuned: a stated search, on situations that no comparison uses.

For every expert, gains are drawn within its ranges by a Latin hypercube on a logarithmic scale;
two thirds over the whole ranges, the rest about the best of them. Each set is judged by the
contest of the study: the same kind of pushes in situations of a seed that is kept for tuning. The
error is the largest of the study's errors while pushed (95 % of the trials), each over its scale;
the yield is the mean peak way of the pushed site. Of all sets the Pareto front is kept, and on it
the least error that goes with the yield that the contest asks for
(:func:`tpsim.study.pareto.least_that_yields`).
"""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from scipy.stats import qmc
from tqdm import tqdm  # type: ignore[import-untyped]

from tpsim.border import Count, SeedNumber, border
from tpsim.errors import ArgumentError, SimulationError
from tpsim.study.condition import Condition
from tpsim.study.contest import Contest
from tpsim.study.expert import Expert, Range
from tpsim.study.pareto import least_that_yields, pareto
from tpsim.study.record import Records
from tpsim.study.recording import Answer, say
from tpsim.study.study import Study
from tpsim.study.summary import plain
from tpsim.study.workers import Death, Workers
from tpsim.task.task import Task, draw_situation
from tpsim.task.verbs import perform
from tpsim.versions import versions
from tpsim.whole import write_text
from tpsim.world.threads import one_thread
from tpsim.world.world import World

SEED = 10_000
"""Seeds from here on are for tuning: the comparisons' own are smaller."""

FINER = 1 / 3
"""Share of the trials, and of the ranges' logarithm, with which the search goes on about the best
gains."""


@dataclass(frozen=True)
class Tried:
    """One set of gains and what it came to.

    Parameters
    ----------
    gains : mapping of str to float
    error : float
        The largest error over its scale.
    figures : mapping of str to float or None
        All figures of the contest.
    """

    gains: Mapping[str, float]
    error: float
    figures: Mapping[str, float | None]

    @property
    def moved(self) -> float:
        """Mean peak way of the pushed site [mm]."""
        return self.figures["displacement_mean_mm"] or 0.0


@border
def tune(
    study: Study,
    *,
    trials: Count = 48,
    seed: SeedNumber = SEED,
    file: Path | None = None,
    workers: Count = 1,
    only: Sequence[str] = (),
    command: str = "",
) -> Answer:
    """Tune the experts of a study's contest and write their gains.

    Parameters
    ----------
    study : Study
    trials : int
        Sets of gains that are tried for each expert.
    seed : int
        Of gains and situations; at least ``SEED``, so that no comparison uses them.
    file : Path, optional
        JSON; by default where the contest has its gains.
    workers : int
        Processes; their number changes no result.
    only : sequence of str, optional
        Experts to tune; the others keep what the file says of them. All by default.
    command : str
        For people who read the file.

    Raises
    ------
    ArgumentError
        If the study has no contest with experts or none of a name, or the seed is one of the
        comparisons'.
    """
    contest = study.contest
    if contest is None or not contest.experts:
        raise ArgumentError(
            f"task '{study.task.name}' has no experts to tune; give its study a "
            "Contest(experts=...)"
        )
    if seed < SEED:
        raise ArgumentError(f"seed {seed} is one of the comparisons'; tune with {SEED} or more")
    if trials < 3:
        raise ArgumentError(f"{trials} trials were asked for; give at least 3")
    file = contest.gains if file is None else file
    if file is None:
        raise ArgumentError("the contest does not say where its gains are; give a file")
    if unknown := set(only) - set(contest.experts):
        raise ArgumentError(
            f"there is no expert {', '.join(sorted(unknown))}; there are "
            f"{', '.join(contest.experts)}"
        )
    about = {
        "seed": seed,
        "trials": trials,
        "situations": contest.tuning_situations,
        "plant": asdict(contest.tuned_on),
        "yield_asked_mm": contest.yielding,
        "versions": versions(("tpsim", "mujoco", "pin", "numpy", "scipy")),
        "command": command or f"tpsim.study.tuning.tune(study, trials={trials}, seed={seed})",
    }
    found = {}
    judges = Judges(study.task, contest, seed, workers)
    for name, expert in contest.experts.items():
        if only and name not in only:
            continue
        say(f"tuning {name}: {trials} sets of {', '.join(expert.ranges)}")
        found[name] = _search(judges, name, expert, trials, seed, contest.yielding)
    kept = (
        json.loads(file.read_text(encoding="utf-8"))["experts"] if only and file.is_file() else {}
    )
    every = kept | {name: one | about for name, one in found.items()}
    content = {"task": study.task.name, "experts": every}
    write_text(file, json.dumps(plain(content), indent=1) + "\n", replace=True)
    return {
        "task": study.task.name,
        "seed": seed,
        "trials": trials,
        "experts": {name: {**one["gains"], **one["figures"]} for name, one in found.items()},  # type: ignore[dict-item]
        "paths": {"gains": str(file)},
    }


Job = tuple[str, Mapping[str, float]]
"""Name of an expert and a set of gains."""


class Judges:
    """What sets of gains come to, tried here or in several processes.

    Parameters
    ----------
    task : Task
    contest : Contest
    seed : int
        Of the situations.
    workers : int
    """

    def __init__(self, task: Task, contest: Contest, seed: int, workers: int = 1):
        self.task, self.contest, self.seed, self.workers = task, contest, seed, workers

    def __call__(self, jobs: Sequence[Job]) -> Iterator[Tried]:
        """Results in the order of the jobs."""
        if self.workers == 1:
            yield from map(judge(self.task, self.contest, self.seed), jobs)
            return
        world = self.task.stage
        scene = world.xml, world.description, dict(world.assets)
        made = self.task, self.contest, self.seed, scene
        with Workers(min(self.workers, len(jobs)), _open, made) as pool:
            for (name, _), found in zip(jobs, pool.map(jobs), strict=True):
                if isinstance(found, Death):
                    raise SimulationError(f"gains of '{name}' were not tried: {found}")
                yield found


def _open(made: tuple) -> "partial[Tried]":  # type: ignore[type-arg]
    task, contest, seed, world = made
    return judge(task.in_world(World(*world)), contest, seed)


def judge(task: Task, contest: Contest, seed: int) -> "partial[Tried]":
    """What says what a set of gains comes to: ``judge(task, contest, seed)((name, gains))``."""
    drawn = [draw_situation(task, seed, index) for index in range(contest.tuning_situations)]
    conditions = [condition for one in drawn for condition in contest.pushed_in(task, one, "tried")]
    return partial(_judged, task, contest, conditions)


def _judged(task: Task, contest: Contest, conditions: Sequence[Condition], job: Job) -> Tried:
    name, gains = job
    expert, records = replace(contest.experts[name], gains=gains), Records(task, {})
    with one_thread():
        for condition in conditions:
            trial = perform(
                task,
                {},
                condition.situation,
                controller=expert(task.stage, {}, condition.situation),
                people=condition.people,
                duration=condition.duration,
                plant=condition.plant,
            )
            records.add(condition, trial)
    figures = contest.figures(records.select(contest.pushed, "tried"))
    errors = [(figures[f"{e.name}_p95_{e.unit}"], e.scale) for e in contest.errors]
    worst = max((value / scale for value, scale in errors if value is not None), default=np.inf)
    return Tried(dict(gains), float(worst), figures)


def _search(
    judges: Judges, name: str, expert: Expert, trials: int, seed: int, asked: float
) -> dict[str, object]:
    """Both rounds of the search, and what is kept of them."""
    finer = max(1, round(FINER * trials))
    ranges = expert.ranges
    tried: list[Tried] = []
    for count, wide in ((trials - finer, None), (finer, FINER)):
        if wide is not None:
            ranges = about(tried[_best(tried, asked)].gains, expert.ranges, wide)
        jobs = [(name, gains) for gains in hypercube(ranges, count, seed + len(tried))]
        tried += tqdm(judges(jobs), total=len(jobs), file=sys.stderr, disable=None)
    kept = pareto({str(k): (one.error, -one.moved) for k, one in enumerate(tried)})
    front = sorted((tried[int(k)] for k, by in kept.items() if not by), key=lambda one: one.error)
    best = tried[_best(tried, asked)]
    return {
        "gains": best.gains,
        "figures": best.figures,
        "ranges": {n: [r.low, r.high, r.unit] for n, r in expert.ranges.items()},
        "front": [{"error": o.error, "yield_mm": o.moved, "gains": o.gains} for o in front],
    }


def _best(tried: Sequence[Tried], asked: float) -> int:
    return least_that_yields([one.error for one in tried], [one.moved for one in tried], asked)


def hypercube(ranges: Mapping[str, Range], count: int, seed: int) -> list[dict[str, float]]:
    """Sets of gains: a Latin hypercube on a logarithmic scale, three digits of each."""
    low = np.log([one.low for one in ranges.values()])
    high = np.log([one.high for one in ranges.values()])
    shares = qmc.LatinHypercube(len(ranges), rng=np.random.default_rng(seed)).random(count)
    return [
        {name: float(f"{value:.3g}") for name, value in zip(ranges, one, strict=True)}
        for one in np.exp(low + shares * (high - low))
    ]


def about(
    gains: Mapping[str, float], ranges: Mapping[str, Range], share: float
) -> dict[str, Range]:
    """Ranges about a set of gains, of a share of their width, within those given."""
    found = {}
    for name, one in ranges.items():
        reach = (one.high / one.low) ** (share / 2)
        low, high = max(one.low, gains[name] / reach), min(one.high, gains[name] * reach)
        found[name] = Range(low, high, one.unit)
    return found
