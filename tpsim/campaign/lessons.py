"""What trials build on: demonstrations and models, in a run folder for each lesson."""

from collections.abc import Sequence
from functools import partial

from tpsim.campaign.campaign import DEMONSTRATIONS, Campaign
from tpsim.campaign.design import Lesson, lesson
from tpsim.campaign.folder import Folder
from tpsim.errors import ArgumentError, RecordingError, SimulationError
from tpsim.study import teaching
from tpsim.study.files.checked import to_json
from tpsim.study.files.inside import checksum
from tpsim.study.files.run import DEMONSTRATIONS as SHOWN
from tpsim.study.files.run import Run, load_run, open_run
from tpsim.study.recording import say
from tpsim.study.study import Study
from tpsim.study.teaching_files import write_demonstrations
from tpsim.study.workers import Death, Executors, Workers
from tpsim.task.verbs import learn
from tpsim.whole import whole_folder
from tpsim.world.threads import one_thread


def prepare(
    folder: Folder, study: Study, numbers: Sequence[int], workers: int, executor: Executors
) -> None:
    """Teach and learn those lessons that are not there yet, side by side."""
    missing = [n for n in numbers if not folder.lesson(n).is_dir()]
    if len(missing) < workers or workers == 1:
        for number in missing:
            make(folder, study, workers, executor, number)
        return
    with Workers(workers, _maker, (folder, study), executor) as pool:
        for number, found in zip(missing, pool.map(missing), strict=True):
            if isinstance(found, Death):
                raise SimulationError(f"lesson {number} was not taught: {found}")


def _maker(given: tuple[Folder, Study]) -> "partial[None]":
    return partial(make, *given, 1, None)


@one_thread()
def make(
    folder: Folder, study: Study, workers: int, executor: Executors | None, number: int
) -> None:
    """Teach and learn one lesson, unless another process just did."""
    campaign = folder.campaign
    own = lesson(campaign, number)
    fields = dict(own.fields)
    count = fields.pop(DEMONSTRATIONS, study.task.demonstrations)
    study = with_fields(study, fields)
    if campaign.labs > 1:
        say(f"lesson {number + 1} of {campaign.labs}: teacher {own.teacher}, {fields or 'as is'}")
    shown = teaching.taught_all(study, int(count), own.teacher, workers, executor)  # type: ignore[call-overload]
    taught = {behaviour: found.trials for behaviour, found in shown.items()}
    models = learn(study.task, taught)
    command = folder.file.command
    try:
        with whole_folder(folder.lesson(number)) as new:
            settings = {"demonstrations": count, **teaching.refused(shown)}
            run = open_run(
                new, study=study, command=command, configuration=settings, seed=own.teacher
            )
            for behaviour, trials in taught.items():
                place = new / SHOWN / behaviour
                write_demonstrations(
                    place, study, behaviour, trials, seed=own.teacher, command=command
                )
            run.save_models(models)
            run.finish()
    except RecordingError:
        if not folder.lesson(number).is_dir():
            raise


def load(folder: Folder, number: int) -> Run:
    """The run folder of a lesson.

    Raises
    ------
    RecordingError
        If anything in it was changed.
    """
    return load_run(folder.lesson(number)).check()


def seal(run: Run) -> str:
    """SHA-256 of the scene and the models of a lesson: results with the same may mix."""
    assert run.file.whole is not None
    shown = {name: sum for name, sum in run.file.whole.files.items() if SHOWN not in name}
    return checksum(to_json(shown).encode())


def study_in(study: Study, own: Lesson, run: Run) -> Study:
    """The study as it is performed after a lesson, in the world of its folder."""
    fields = {name: value for name, value in own.fields.items() if name != DEMONSTRATIONS}
    study = with_fields(study, fields)
    return study.in_world(run.world)


def with_fields(study: Study, fields: dict[str, object]) -> Study:
    """The study with other fields of its task.

    Raises
    ------
    ArgumentError
        If the task refuses a value.
    """
    try:
        return study.with_task(**fields) if fields else study
    except (ValueError, TypeError) as error:
        raise ArgumentError(f"task '{study.task.name}' refuses {fields}: {error}") from None


def refused(folder: Folder, campaign: Campaign) -> int:
    """How many demonstrations were refused in all lessons that are there."""
    there = (n for n in range(campaign.labs) if folder.lesson(n).is_dir())
    found = (load_run(folder.lesson(n)).file.configuration for n in there)
    return sum(int(str(settings.get("refused_demonstrations", 0))) for settings in found)
