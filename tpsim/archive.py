"""Archives of arrays (.npz): written whole or not at all, read without pickles."""

import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from tpsim.errors import RecordingError
from tpsim.whole import whole_file


def save_arrays(path: str | Path, kind: str, arrays: Mapping[str, np.ndarray]) -> Path:
    """Write named arrays to ``path``, under a temporary name until the file is complete.

    Parameters
    ----------
    path : file name
        Its folder is made where it is missing.
    kind : str
        What the archive holds; :func:`load_arrays` refuses another kind.
    arrays : mapping of names to arrays
        Numbers or text, no objects.
    """
    path = Path(path)
    with whole_file(path) as file:
        np.savez(file, allow_pickle=False, kind=np.array(kind), **arrays)
    return path


def load_arrays(path: str | Path, kind: str) -> dict[str, np.ndarray]:
    """Read the arrays of an archive.

    Raises
    ------
    RecordingError
        The file is missing, truncated, holds pickles, or is of another kind.
    """
    path = Path(path)
    if not path.is_file():
        raise RecordingError(f"there is no file {path}; give the name that save() was given")
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (
        OSError,
        ValueError,
        EOFError,
        KeyError,
        TypeError,
        AttributeError,
        zlib.error,
        zipfile.BadZipFile,
    ) as error:
        raise RecordingError(f"{path} is truncated or no archive of arrays ({error})") from error
    found = str(arrays.pop("kind", "of unknown kind"))
    if found != kind:
        raise RecordingError(f"{path} is {found}; a {kind} was asked for")
    return arrays
