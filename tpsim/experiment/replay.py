"""Does a run repeat? Its trials are performed again, from its own folder alone."""

import numpy as np

from tpsim import tasks
from tpsim.errors import RecordingError
from tpsim.experiment.conditions import Condition
from tpsim.experiment.doctor import versions
from tpsim.experiment.recording import Run
from tpsim.learning.tp_gmm import TPGMM


def replay(run: Run) -> dict:
    """Perform the trials of a run again and compare all signals bit for bit.

    Scene, models and conditions come from the run's folder and from nothing else.

    Returns
    -------
    dict
        ``trials``, ``identical``, ``largest_difference`` over all signals (each in its SI unit),
        ``different`` (names of the files that differ) and ``other_versions`` (packages that have
        changed since the recording).

    Raises
    ------
    RecordingError
        Where the folder holds no models or no trials.
    """
    models = {
        file.stem.removeprefix("model-"): TPGMM.load(file)
        for file in sorted(run.folder.glob("model-*.npz"))
    }
    files = run.files()
    if not models or not files:
        raise RecordingError(
            f"{run.folder} holds no models or no trials; give a whole run's folder"
        )
    different, largest, bench = [], 0.0, None
    for file, recorded in zip(files, run.trials(), strict=True):
        if bench is None:
            task = tasks.load(recorded.about["task"])
            bench = task, task.simulation(run.scene), models
        again = Condition.from_about(recorded.about).perform(*bench)
        difference = _difference(recorded.arrays, again.arrays)
        if difference > 0 or recorded.outcome != again.outcome:
            different.append(file.name)
        largest = max(largest, difference)
    return {
        "trials": len(files),
        "identical": len(files) - len(different),
        "largest_difference": largest,
        "different": different,
        "other_versions": _changes(run.description["versions"]),
    }


def compare_runs(recorded: Run, again: Run) -> dict:
    """Compare a run with its repetition.

    Returns
    -------
    dict
        ``trials``, ``identical`` (how many files are the same bytes), ``largest_difference`` over
        all signals (each in its SI unit), ``different`` (names of the files that differ) and
        ``other_versions`` (packages that have changed since the recording).

    Raises
    ------
    RecordingError
        Where there is nothing to compare, or the runs have not the same trials.
    """
    names = [file.name for file in recorded.files()]
    if not names:
        raise RecordingError(f"{recorded.folder} holds no trials; give the folder of a whole run")
    if names != [file.name for file in again.files()]:
        raise RecordingError(
            f"{recorded.folder} holds {len(names)} trials, its repetition {len(again.files())}; "
            "the run was interrupted: record it again"
        )
    pairs = zip(recorded.files(), again.files(), strict=True)
    same = [one.read_bytes() == other.read_bytes() for one, other in pairs]
    trials = zip(recorded.trials(), again.trials(), strict=True)
    return {
        "trials": len(names),
        "identical": sum(same),
        "largest_difference": max(_difference(one.arrays, other.arrays) for one, other in trials),
        "different": [name for name, equal in zip(names, same, strict=True) if not equal],
        "other_versions": _changes(recorded.description["versions"]),
    }


def _difference(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    """Largest difference of two trials' signals; infinite where their shapes differ."""
    if {n: a.shape for n, a in one.items()} != {n: a.shape for n, a in other.items()}:
        return float("inf")
    return max(float(np.max(np.abs(one[n] - other[n].astype(float)), initial=0)) for n in one)


def _changes(then: dict[str, str | None]) -> list[str]:
    now = versions(tuple(then.keys() - {"python"}))
    changed = sorted(name for name in then if then[name] != now.get(name))
    return [f"{name} {then[name]} then, {now.get(name)} now" for name in changed]
