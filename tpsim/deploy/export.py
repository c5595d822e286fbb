"""The verb export: learn from recorded demonstrations, and write a policy."""

from pathlib import Path

from tpsim import paths
from tpsim.deploy.policy import Policy
from tpsim.study.recording import Answer
from tpsim.study.study import Study
from tpsim.study.teaching import Source, models_of
from tpsim.whole import check_free
from tpsim.world.threads import one_thread


@one_thread()
def export(
    study: Study, demonstrations: Source | None = None, folder: Path | None = None
) -> Answer:
    """Learn every behaviour of a study's task, and write the policy to a new folder.

    Parameters
    ----------
    study : Study
    demonstrations : Path, Run or mapping of str to sequence of Trial, optional
        A folder that ``tpsim teach`` wrote, ``recordings/demonstrations`` by default; a run, whose
        models are taken as they are; or the demonstrations themselves.
    folder : Path, optional
        ``recordings/policies/<task>`` by default.

    Raises
    ------
    RecordingError
        If the folder exists, or demonstrations are missing.
    ArgumentError
        If no policy can be made of the task's controller.
    """
    task = study.task
    target = paths.recordings() / "policies" / task.name if folder is None else folder
    check_free(target)
    models = models_of(study, demonstrations)
    policy = Policy(task, models)
    return {
        "task": task.name,
        "behaviours": list(models),
        "joints": list(policy.robot.joints),
        "hands": list(policy.robot.hands),
        "objects": list(policy.objects),
        "period": policy.period,
        "paths": {"policy": str(policy.save(target))},
    }
