"""Models in a folder: ``model-<behaviour>.npz`` of every behaviour."""

import re
from pathlib import Path

from tpsim.errors import RecordingError, one_line
from tpsim.learning.tp_gmm import TPGMM
from tpsim.study.files.inside import inside
from tpsim.task.task import Models

_PREFIX = "model-"


def save_models(folder: Path, models: Models) -> list[Path]:
    """Write the models of all behaviours to a folder; return the files.

    Raises
    ------
    RecordingError
        If the folder holds models: nothing is overwritten.
    """
    files = {name: folder / f"{_PREFIX}{name}.npz" for name in models}
    for name in files:
        if not re.fullmatch(r"\w[\w. -]*", name):
            raise RecordingError(f"'{name}' is no name of a file: give the behaviour another one")
    if there := model_files(folder):
        raise RecordingError(
            f"{folder} holds models already ({', '.join(there)}); give a new folder, nothing is "
            "overwritten"
        )
    return [models[name].save(file) for name, file in files.items()]


def model_files(folder: Path) -> dict[str, Path]:
    """Files of the models in a folder, by behaviour."""
    return {
        file.stem.removeprefix(_PREFIX): inside(folder, file.name)
        for file in sorted(folder.glob(f"{_PREFIX}*.npz"))
    }


def load_models(folder: Path) -> dict[str, TPGMM]:
    """Read the models of all behaviours; none where there are none.

    Raises
    ------
    RecordingError
        If a file holds something else.
    """
    return {name: _load(file) for name, file in model_files(folder).items()}


def _load(file: Path) -> TPGMM:
    try:
        return TPGMM.load(file)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        reason = one_line(error)
        raise RecordingError(f"{file} is no model ({reason}); learn it again") from None
