"""Write demonstrations and trials to files of any known format."""

from collections.abc import Callable, Sequence
from pathlib import Path

from tpsim.border import border
from tpsim.data.signals import Item
from tpsim.data.writers.lerobot import write_lerobot
from tpsim.data.writers.mcap import write_mcap
from tpsim.data.writers.robomimic import write_robomimic
from tpsim.data.writers.table import write_csv
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError

_WRITERS: dict[str, Callable[[Path, Sequence[Item]], Path]] = {
    ".csv": write_csv,
    ".hdf5": write_robomimic,
    ".h5": write_robomimic,
    ".mcap": write_mcap,
    "": write_lerobot,
}


@border
def write(path: str | Path, items: Sequence[Item]) -> list[Path]:
    """Write demonstrations or trials in the format that the path's ending names.

    Parameters
    ----------
    path : file or folder
        Ends with .csv, .hdf5 (robomimic), .mcap or .npz; without an ending, a LeRobot dataset.
    items : sequence of demonstrations, or of trials as arrays by name
        To .npz only demonstrations, one file each: several are numbered, ``name-000.npz``.

    Returns
    -------
    list of Path
        The files or the folder.

    Raises
    ------
    ArgumentError
        An ending that is not known, or nothing to write.
    """
    path = Path(path)
    if path.suffix == ".npz":
        return _to_npz(path, items)
    writer = _WRITERS.get(path.suffix)
    if writer is None:
        raise ArgumentError(
            f"{path} ends with {path.suffix}; give .npz, {', '.join(filter(None, _WRITERS))}, or a "
            "folder for a LeRobot dataset"
        )
    return [writer(path, items)]


def _to_npz(path: Path, items: Sequence[Item]) -> list[Path]:
    demonstrations = [item for item in items if isinstance(item, Demonstration)]
    if not demonstrations or len(demonstrations) < len(items):
        raise ArgumentError(f"{path}: give demonstrations, at least one; .npz takes nothing else")
    if len(demonstrations) == 1:
        return [demonstrations[0].save(path)]
    return [d.save(path.with_stem(f"{path.stem}-{i:03d}")) for i, d in enumerate(demonstrations)]
