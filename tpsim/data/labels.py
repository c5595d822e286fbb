"""What the columns of a demonstration are called, for people."""

from collections.abc import Iterator

from tpsim.data.columns import Columns, Names, listed
from tpsim.data.movement import described
from tpsim.data.recording import Recording
from tpsim.data.signals import parts_of
from tpsim.data.table import Table

POSITION = ("x [m]", "y [m]", "z [m]")
QUATERNION = ("qw", "qx", "qy", "qz")


def labels_of(recording: Recording, columns: Columns) -> list[str]:
    """Name the D columns that :func:`tpsim.data.read` makes of a recording, with known units."""
    columns = described(recording, columns)
    table = Table.of(recording, columns)
    n = table.values(columns.position).shape[1]
    labels = list(POSITION[:n])
    if columns.orientation:
        labels += QUATERNION
    labels += [f"{name} [rad]" for name in _named(table, columns.joints)]
    return labels + list(_named(table, columns.other))


def _named(table: Table, names: Names | None) -> Iterator[str]:
    for name in listed(names):
        series, values = table.recording.find(name)
        found = series.names_of(name)
        whole = len(found) == values.shape[1] and len(found) > 0
        yield from found if whole else parts_of(str(name), values.shape[1])
