"""The verb export: learn from recorded demonstrations, and write a policy."""

from pathlib import Path

from tpsim import paths
from tpsim.deploy.policy import Policy
from tpsim.study.recording import Answer
from tpsim.study.study import Study
from tpsim.study.teaching import demonstrations_of
from tpsim.task.verbs import Taught, learn
from tpsim.whole import check_free
from tpsim.world.threads import one_thread


@one_thread()
def export(
    study: Study, demonstrations: Path | Taught | None = None, folder: Path | None = None
) -> Answer:
    """Learn every behaviour of a study's task, and write the policy to a new folder.

    Parameters
    ----------
    study : Study
    demonstrations : Path or mapping of str to sequence of Trial, optional
        A folder that ``tpsim teach`` wrote, ``recordings/demonstrations`` by default; or the
        demonstrations themselves.
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
    taught = demonstrations_of(study, demonstrations)
    policy = Policy(task, learn(task, taught))
    return {
        "task": task.name,
        "demonstrations": {name: len(trials) for name, trials in taught.items()},
        "joints": list(policy.robot.joints),
        "hands": list(policy.robot.hands),
        "objects": list(policy.objects),
        "period": policy.period,
        "paths": {"policy": str(policy.save(target))},
    }
