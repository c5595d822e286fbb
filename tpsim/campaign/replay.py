"""Do trials of a campaign repeat? They are performed again, from its folder alone."""

from collections.abc import Callable, Sequence
from pathlib import Path

from tpsim.campaign.figures import digest
from tpsim.campaign.folder import Folder
from tpsim.campaign.performing import Bench
from tpsim.campaign.run import study_of
from tpsim.campaign.table import FAILED
from tpsim.errors import ArgumentError, RecordingError
from tpsim.film import rendering
from tpsim.film.video import film
from tpsim.study.clips import clip_of
from tpsim.study.files.run_file import differing
from tpsim.study.files.trial_file import load_trial
from tpsim.study.recording import Answer
from tpsim.study.reference import is_ours
from tpsim.study.replay import difference_of
from tpsim.study.study import Study
from tpsim.study.workers import Death, Workers


def replay(
    folder: Folder, numbers: Sequence[int] = (), study: Study | None = None, workers: int = 1
) -> Answer:
    """Perform trials of a campaign again, and compare them with what is kept, bit for bit.

    Parameters
    ----------
    folder : Folder
    numbers : sequence of int
        Of the trials; all that are done by default.
    study : Study, optional
        Of the campaign; those that tpsim brings are found by themselves.
    workers : int
        Processes.

    Returns
    -------
    dict
        ``verdict`` in words, ``repeats``, ``trials``, ``identical``, ``different`` (their
        numbers), ``other_versions`` (what has changed since and may change bits).

    Raises
    ------
    RecordingError
        If a trial was not performed, or anything in the folder was changed.
    ArgumentError
        If the study is the caller's own and was not given.
    """
    kept = _digests(folder)
    if missing := [n for n in numbers if n not in kept]:
        raise RecordingError(f"{folder.path} holds no trial {missing[0]} that was performed")
    chosen = list(numbers) or sorted(kept)
    if not chosen:
        raise RecordingError(f"{folder.path} holds no trials that were performed")
    given = folder, _study(folder, study)
    different = []
    with Workers(min(workers, len(chosen)), _checker, given) as pool:
        for number, found in zip(chosen, pool.map(chosen), strict=True):
            if isinstance(found, Death) or found != kept[number]:
                different.append(number)
    count = len(chosen)
    same = f"all {count} trials" if count > 1 else f"trial {chosen[0]}"
    return {
        "verdict": f"{len(different)} of {count} trials differ"
        if different
        else f"{same} came out again, bit for bit",
        "repeats": not different,
        "trials": count,
        "identical": count - len(different),
        "different": different,
        "other_versions": differing(folder.file.versions),
    }


def film_of(folder: Folder, number: int, study: Study | None = None) -> Path:
    """Film one trial of a campaign, performed again; return the file.

    Raises
    ------
    RenderingError
        If nothing draws here.
    """
    rendering.environment()
    bench = Bench(folder, _study(folder, study), same=False)
    shown, title = bench.lab(number), f"Trial {number}"
    return film(
        [clip_of(shown, bench.trial(number), title, bench.said(number))],
        folder.path / "films" / f"trial-{number:06d}.mp4",
    )


def _study(folder: Folder, study: Study | None) -> Study:
    reference = folder.campaign.study
    if study is None and not is_ours(reference):
        raise ArgumentError(
            f"{folder.path} is of the study {reference}; name it yourself if you trust it: "
            f"--study {reference}"
        )
    return study_of(folder.campaign, study)


def _digests(folder: Folder) -> dict[int, str]:
    found = {}
    for table in folder.tables(["trial", "outcome", "digest"]):
        for row in table.to_pylist():
            if row["outcome"] != FAILED:
                found[row["trial"]] = row["digest"]
    return found


def _checker(given: tuple[Folder, Study]) -> Callable[[int], str]:
    folder, bench = given[0], Bench(*given, same=False)

    def again(number: int) -> str:
        """Digest of a trial; nothing where its recording says otherwise."""
        trial = bench.trial(number)
        path = folder.trial(number)
        if path.is_file() and difference_of(load_trial(path), trial) is not None:
            return ""
        return digest(trial)

    return again
