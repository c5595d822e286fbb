"""Rows of figures in Parquet: a file for each block of trials, and one table of all."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tpsim.errors import RecordingError, one_line
from tpsim.extras import extra
from tpsim.whole import whole_path

if TYPE_CHECKING:
    import pyarrow

Row = dict[str, Any]
"""Figures of one trial by name."""

WHOLE = ("trial", "point", "lesson", "teacher", "situation")
TEXTS = ("controller", "plant", "body", "outcome", "reason", "twin_outcome", "digest")

FAILED = "failed"
"""Outcome of a trial that could not be performed; its ``reason`` says why."""


def write_rows(
    path: Path, rows: Sequence[Row], about: Mapping[str, str], replace: bool = False
) -> Path:
    """Write rows to a file, whole or not at all.

    Parameters
    ----------
    path : Path
    rows : sequence of dict
        Numbers, texts and truth values by name; None where there is nothing to say.
    about : mapping of str to str
        Of what the rows are.
    replace : bool
        Whether an earlier file gives way.
    """
    with extra("Tables of campaigns"):
        import pyarrow

    names = dict.fromkeys(name for row in rows for name in row)
    columns = {name: [row.get(name) for row in rows] for name in names}
    schema = pyarrow.schema(
        [pyarrow.field(name, _kind(name, values)) for name, values in columns.items()],
        metadata=dict(about),
    )
    return write_table(path, pyarrow.table(columns, schema=schema), replace)


def write_table(path: Path, table: "pyarrow.Table", replace: bool = False) -> Path:
    """Write a table to a file, whole or not at all."""
    import pyarrow.parquet

    with whole_path(path, replace=replace) as temporary:
        pyarrow.parquet.write_table(table, temporary, compression="zstd")
    return path


def _kind(name: str, values: Sequence[object]) -> "pyarrow.DataType":
    import pyarrow

    if name in WHOLE:
        return pyarrow.int64()
    there = [value for value in values if value is not None]
    if name in TEXTS or any(isinstance(value, str) for value in there):
        return pyarrow.string()
    if there and all(isinstance(value, bool) for value in there):
        return pyarrow.bool_()
    return pyarrow.float64()


def read_table(
    path: Path, about: Mapping[str, str] | None = None, columns: Sequence[str] | None = None
) -> "pyarrow.Table":
    """Read the rows of a file.

    Parameters
    ----------
    path : Path
    about : mapping of str to str, optional
        What the file has to say of itself.
    columns : sequence of str, optional
        All by default; those that are not there are left out.

    Raises
    ------
    RecordingError
        If it is damaged, or of other trials.
    """
    with extra("Tables of campaigns"):
        import pyarrow.parquet
    try:
        with pyarrow.parquet.ParquetFile(path) as file:
            found = file.schema_arrow
            if columns is not None:
                columns = [name for name in columns if name in found.names]
            table = file.read(columns)
    except (OSError, ValueError, pyarrow.ArrowException) as error:
        raise RecordingError(
            f"{path} is damaged ({one_line(error, 120)}); delete it and run the campaign again"
        ) from None
    said = {k.decode(): v.decode() for k, v in (found.metadata or {}).items()}
    for name, wanted in (about or {}).items():
        if said.get(name) != wanted:
            raise RecordingError(
                f"{path} has another {name} than this campaign; move it away and run again"
            )
    return table
