"""Blocks of trials performed: one worker holds lessons and twins, and only figures leave it."""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from threading import Lock
from typing import TypeVar

from tpsim.campaign import lessons
from tpsim.campaign.design import Asked, asked, lead_of, push_of, trials_of
from tpsim.campaign.figures import UNPUSHED, asked_row, digest, failed_row, figures_row
from tpsim.campaign.folder import Folder, check_versions
from tpsim.campaign.people import Leads, Pushes
from tpsim.campaign.signals import write_signals
from tpsim.campaign.table import FAILED, Row, write_rows
from tpsim.errors import RecordingError
from tpsim.study.condition import Condition
from tpsim.study.executor import perform_condition, perform_pushed
from tpsim.study.files.trial_file import save_trial
from tpsim.study.leading import led_off
from tpsim.study.record import Record, Records
from tpsim.study.study import Lab, Study
from tpsim.task.task import Models, Situation, draw_situation
from tpsim.world.threads import one_thread
from tpsim.world.trial import Trial

T = TypeVar("T")

_LESSONS, _TWINS, _SITUATIONS = 4, 32, 4
"""How many a worker remembers: its memory does not grow with the campaign."""


@dataclass(frozen=True)
class Done:
    """What a worker says of the trials that it performed.

    Parameters
    ----------
    trials, failed : int
    simulated : float
        Time [s].
    rows : tuple of dict
        Those that it did not write.
    """

    trials: int
    failed: int
    simulated: float
    rows: tuple[Row, ...] = ()


@dataclass(frozen=True)
class Job:
    """Trials of one block: all of them, which are written, or some, whose rows are returned."""

    block: int
    trials: tuple[int, ...] | None = None


class Bench:
    """Performs trials of a campaign in one process.

    Parameters
    ----------
    folder : Folder
    study : Study
        Of the campaign, with its own fields.
    same : bool
        Whether the versions here have to be those of the folder.

    Raises
    ------
    RecordingError
        If the versions here are not those of the folder.
    """

    def __init__(self, folder: Folder, study: Study, same: bool = True):
        if same:
            check_versions(folder)
        self._folder, self._study = folder, study
        self._plants = folder.campaign.all_plants
        self._lessons: OrderedDict[object, tuple[Study, Models, str]] = OrderedDict()
        self._twins: OrderedDict[object, Record] = OrderedDict()
        self._situations: OrderedDict[object, Situation] = OrderedDict()
        self._ready: dict[int, Trial] = {}
        self._shares: dict[object, bool] = {}
        self._lock = Lock()

    def perform(self, job: Job) -> Done:
        """Perform a job; several threads take turns."""
        with self._lock, one_thread():
            return self._perform(job)

    def trial(self, number: int) -> Trial:
        """Trial ``number`` alone."""
        with self._lock, one_thread():
            found = asked(self._folder.campaign, number)
            return self._performed(found, self._condition(found))

    def lab(self, number: int) -> Lab:
        """The study, world and models of one trial."""
        return Lab(*self._lesson(asked(self._folder.campaign, number)))

    def said(self, number: int) -> str:
        """What one trial is, in a line."""
        found = asked(self._folder.campaign, number)
        parts = [found.controller, found.plant, f"situation {found.situation}"]
        return ", ".join([*parts, *(f"{k} {_short(v)}" for k, v in found.drawn.items())])

    def row(self, number: int) -> tuple[Row, Trial | None]:
        """Figures of one trial, and the trial; None where it failed."""
        found = asked(self._folder.campaign, number)
        row = asked_row(found, None)
        try:
            condition = self._condition(found)
            row = asked_row(found, condition)
            twin = self._twin(found)
            trial = self._performed(found, condition) if condition.people else twin.trial
            study, models = self._lesson(found)
            success = self._folder.campaign.success
            return figures_row(row, study, models, condition, trial, twin, success), trial
        except (RecordingError, MemoryError):
            raise
        except Exception as error:  # whatever a user's code raises is a row
            return failed_row(row, f"{type(error).__name__}: {error}"), None

    def _perform(self, job: Job) -> Done:
        folder, keep = self._folder, self._folder.campaign.keep
        numbers = trials_of(folder.campaign, job.block) if job.trials is None else job.trials
        rows, signals = [], []
        self._perform_together(numbers)
        for number in numbers:
            row, trial = self.row(number)
            rows.append(row)
            if trial is not None and keep == "everything":
                # A worker whose scheduler died may still be at the same, with the same bits.
                save_trial(folder.trial(number), trial, replace=True)
            if trial is not None and keep != "figures":
                signals.append((number, trial))
        if signals:
            write_signals(folder.signals(job.block), signals, folder.about)
        done = Done(
            len(rows),
            sum(row["outcome"] == FAILED for row in rows),
            sum(row.get("simulated_s", 0.0) for row in rows),
        )
        if job.trials is not None:
            return replace(done, rows=tuple(rows))
        self.write(job.block, rows)
        return done

    def write(self, block: int, rows: Sequence[Row]) -> None:
        """Write the rows of a block: it is done then."""
        seals = {f"lesson {n}": self._lesson_number(n)[2] for n in {r["lesson"] for r in rows}}
        write_rows(self._folder.rows(block), rows, self._folder.about | seals, replace=True)

    def _lesson_number(self, number: int) -> tuple[Study, Models, str]:
        def load() -> tuple[Study, Models, str]:
            run = lessons.load(self._folder, number)
            own = lessons.lesson(self._folder.campaign, number)
            return lessons.study_in(self._study, own, run), run.models, lessons.seal(run)

        return _kept(self._lessons, number, _LESSONS, load)

    def _lesson(self, found: Asked) -> tuple[Study, Models]:
        study, models, _ = self._lesson_number(found.lesson.number)
        if found.fields:
            world = study.task.stage
            study = lessons.with_fields(study, dict(found.fields)).in_world(world)
        return study, models

    def _situation(self, found: Asked) -> Situation:
        study, _ = self._lesson(found)
        key = found.twin[:3]
        draw = partial(draw_situation, study.task, found.lesson.teacher, found.situation)
        return _kept(self._situations, key, _SITUATIONS, draw)

    def _rest(self, found: Asked) -> Condition:
        """The trial without anybody who disturbs it."""
        return Condition(
            UNPUSHED,
            self._situation(found),
            found.controller,
            plant=self._plants[found.plant],
            duration=self._folder.campaign.duration,
        )

    def _condition(self, found: Asked) -> Condition:
        """What is performed, a lead from where the twin's site is."""
        campaign, (study, _) = self._folder.campaign, self._lesson(found)
        rest = self._rest(found)
        duration = campaign.duration or study.task.duration
        hand = next(iter(study.task.stage.robot.hands.values()))
        people = campaign.people
        if isinstance(people, Pushes):
            push = push_of(people, found.drawn, duration, hand)
            return replace(rest, label="pushed", push=(push,))
        if isinstance(people, Leads):
            lead = lead_of(people, found.drawn, duration, hand)
            return replace(led_off(self._twin(found), lead), label="led")
        return rest

    def _twin(self, found: Asked) -> Record:
        """The same trial undisturbed."""

        def performed() -> Record:
            (study, models), rest = self._lesson(found), self._rest(found)
            return Records(study.task, models).add(rest, self._performed(found, rest))

        return _kept(self._twins, found.twin, _TWINS, performed)

    def _performed(self, found: Asked, condition: Condition) -> Trial:
        if (ready := self._ready.pop(found.trial, None)) is not None:
            return ready
        study, models = self._lesson(found)
        return perform_condition(study, models, condition)

    def _perform_together(self, numbers: Sequence[int]) -> None:
        """Perform trials that share their twin up to their pushes, so that this is done once."""
        self._ready.clear()
        groups: dict[object, list[Asked]] = {}
        if isinstance(self._folder.campaign.people, Pushes):
            for found in (asked(self._folder.campaign, number) for number in numbers):
                groups.setdefault(found.twin, []).append(found)
        for twin, group in groups.items():
            kind = (group[0].lesson.number, group[0].controller, group[0].plant)
            if twin in self._twins or len(group) < 2 or self._shares.get(kind) is False:
                continue
            try:
                self._share(twin, group, kind)
            except MemoryError:
                raise
            except Exception:  # alone, each says what is wrong with it
                self._shares[kind] = False

    def _share(self, twin: object, group: Sequence[Asked], kind: object) -> None:
        (study, models), first = self._lesson(group[0]), group[0]
        conditions = [self._condition(found) for found in group]
        rest = replace(conditions[0], label=UNPUSHED, push=())
        undisturbed, *trials = perform_pushed(study, models, rest, conditions)
        if kind not in self._shares:
            # A controller may hold what cannot be copied: bits tell.
            alone = perform_condition(study, models, conditions[0])
            self._shares[kind] = digest(alone) == digest(trials[0])
        if self._shares[kind]:
            record = Records(study.task, models).add(rest, undisturbed)
            _kept(self._twins, first.twin, _TWINS, lambda: record)
            self._ready |= {found.trial: t for found, t in zip(group, trials, strict=True)}


def bench(given: tuple[Folder, Study]) -> Callable[[Job], Done]:
    """What a worker does with jobs."""
    return Bench(*given).perform


def _short(value: object) -> str:
    if isinstance(value, tuple):
        return " ".join(map(_short, value))
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _kept(memory: "OrderedDict[object, T]", key: object, most: int, make: Callable[[], T]) -> T:
    """A value that is made once, as long as it is remembered."""
    if key not in memory:
        memory[key] = make()
        if len(memory) > most:
            memory.popitem(last=False)
    memory.move_to_end(key)
    return memory[key]
