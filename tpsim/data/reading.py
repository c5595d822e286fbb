"""Read demonstrations from files of any known format."""

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from tpsim.border import border
from tpsim.checks import shown
from tpsim.data.build import demonstrations_of
from tpsim.data.columns import Columns
from tpsim.data.foreign import check_ordinary
from tpsim.data.recording import Recording
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError, RecordingError

FORMATS = {
    "npz": "arrays",
    "text": "text",
    "tum": "text",
    "euroc": "text",
    "mat": "matlab",
    "rosbag": "rosbag",
    "mcap": "mcap",
    "lerobot": "lerobot",
    "robomimic": "hdf5",
}
"""Names of the formats that are read, each with the module that reads it."""

_SUFFIXES = {
    ".npz": "npz",
    ".npy": "npz",
    ".mat": "mat",
    ".bag": "rosbag",
    ".mcap": "mcap",
    ".hdf5": "robomimic",
    ".h5": "robomimic",
}
_SUFFIXES |= dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".log", ".tum"), "text")


@border
def read(
    path: str | Path | Sequence[str | Path],
    columns: Columns | None = None,
    *,
    format: str | None = None,
) -> list[Demonstration]:
    """Read demonstrations from a file, a folder of files, or several files.

    Parameters
    ----------
    path : file or folder, or a sequence of them
        npz; CSV, TSV or other text; TUM or EuRoC trajectory; MATLAB .mat; ROS 1 bag or ROS 2 bag
        folder; MCAP; LeRobot dataset folder; robomimic or robosuite HDF5.
    columns : Columns, optional
        What the file does not say. Without it the columns are recognised by their names;
        :func:`tpsim.data.info` shows which.
    format : str, optional
        One of :data:`FORMATS`; default by the file's name and content.

    Returns
    -------
    list of Demonstration
        Positions in [m], then orientations as quaternions (w, x, y, z), then joints [rad] and other
        columns. Quaternions have the same sign in neighbouring samples and across demonstrations.
        Time is in [s] as in the file; stamps of a clock (Unix time) count from the first sample.

    Raises
    ------
    RecordingError
        No such file, a file that is truncated or of another kind, columns that are not there, rows
        that cannot be used, or an optional package that is missing. One line, which names the row.
    ArgumentError
        A description that contradicts itself.
    """
    return demonstrations_of(recordings(path, format=format), columns or Columns())


@border
def recordings(
    path: str | Path | Sequence[str | Path], *, format: str | None = None
) -> list[Recording]:
    """Read what files hold, before anybody says what their columns mean.

    Parameters and errors are those of :func:`read`.

    Returns
    -------
    list of Recording
        One for every demonstration that the format itself tells apart.
    """
    if format is not None and format not in FORMATS:
        raise ArgumentError(f"format is {shown(format)}; give one of {', '.join(FORMATS)}")
    paths = [Path(path)] if isinstance(path, str | Path) else [Path(one) for one in path]
    found = [recording for one in paths for recording in _recordings(one, format)]
    if not found:
        raise RecordingError(f"{', '.join(map(str, paths)) or 'no path'}: holds no recording")
    return found


def format_of(path: Path) -> str | None:
    """Name of the format of a file or folder; None of a folder of files.

    Raises
    ------
    RecordingError
        There is no such file, or its format is not known.
    """
    if not path.exists():
        raise RecordingError(f"there is no file {path}")
    if path.is_dir():
        if (path / "meta" / "info.json").exists():
            return "lerobot"
        return "rosbag" if (path / "metadata.yaml").exists() else None
    if path.suffix == ".db3":
        raise RecordingError(f"{path}: give the folder of the bag, which holds metadata.yaml")
    known = _SUFFIXES.get(path.suffix.lower())
    if known is None:
        raise RecordingError(
            f"{path}: {path.suffix or 'a name without ending'} is no known kind of recording; "
            f"give one of {', '.join(_SUFFIXES)}, a folder, or format="
        )
    return known


def _recordings(path: Path, format: str | None) -> list[Recording]:
    known = format_of(path) if format is None else format
    if path.exists():
        check_ordinary(path)
    if known is None:
        files = [one for one in sorted(path.iterdir()) if one.suffix.lower() in _SUFFIXES]
        if not files:
            raise RecordingError(f"{path} is a folder without recordings")
        return [recording for one in files for recording in _recordings(one, None)]
    if not path.exists():
        raise RecordingError(f"there is no file {path}")
    reader: Callable[[Path], list[Recording]]
    reader = import_module(f"tpsim.data.readers.{FORMATS[known]}").recordings
    return reader(path)
