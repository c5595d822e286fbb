"""The folder of a campaign: its files are its state, and any process can go on from them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tpsim.campaign.campaign import Campaign
from tpsim.campaign.design import block_size, blocks
from tpsim.campaign.table import read_table
from tpsim.errors import RecordingError
from tpsim.study.files import limits
from tpsim.study.files.checked import from_json, plain, to_json
from tpsim.study.files.inside import checksum, read_text_inside
from tpsim.study.files.run_file import differing, environment, git_commit, now
from tpsim.whole import sweep, write_text

if TYPE_CHECKING:
    import pyarrow

FILE = "campaign.json"

SCHEMA = 1
"""Version of the layout of the folder."""

_SHELF = 1000
"""Files in one folder, at most."""


@dataclass(frozen=True)
class CampaignFile:
    """Content of ``campaign.json``.

    Parameters
    ----------
    schema : int
    campaign : Campaign
    block : int
        Trials in a file of rows.
    versions : dict of str to str
        On which bits depend.
    command : str
        What was typed first.
    started : str
        When.
    git_commit : str, optional
        Of the checkout that ran.
    """

    schema: int
    campaign: Campaign
    block: int
    versions: dict[str, str | None]
    command: str
    started: str
    git_commit: str | None

    @property
    def mark(self) -> str:
        """SHA-256 of what is tried and of what bits depend on: results with the same may mix."""
        return checksum(to_json([self.campaign, self.versions, self.block]).encode())


@dataclass(frozen=True)
class Folder:
    """A campaign's folder.

    Parameters
    ----------
    path : Path
    file : CampaignFile
    """

    path: Path
    file: CampaignFile

    @property
    def campaign(self) -> Campaign:
        """What is tried."""
        return self.file.campaign

    @property
    def about(self) -> dict[str, str]:
        """What files of rows say of themselves."""
        return {"campaign": self.file.mark}

    @property
    def lessons(self) -> Path:
        """Folder of what was taught and learned."""
        return self.path / "lessons"

    def lesson(self, number: int) -> Path:
        """Run folder of a lesson: its demonstrations, models and scene."""
        return self.lessons / f"{number:06d}"

    def rows(self, block: int) -> Path:
        """File of the figures of a block of trials: they are done when it is there."""
        return self.path / "table" / _shelf(block) / f"block-{block:06d}.parquet"

    def signals(self, block: int) -> Path:
        """File of the signals of a block of trials."""
        return self.path / "signals" / _shelf(block) / f"block-{block:06d}.parquet"

    def trial(self, number: int) -> Path:
        """File of the whole recording of a trial."""
        return self.path / "trials" / _shelf(number) / f"trial-{number:06d}.npz"

    def done(self) -> list[int]:
        """Blocks whose rows are there."""
        files = self.path.glob("table/*/block-*.parquet")
        return sorted(int(file.stem.removeprefix("block-")) for file in files)

    @property
    def complete(self) -> bool:
        """Whether all blocks are done."""
        return len(self.done()) == blocks(self.campaign)

    def tables(self, columns: list[str] | None = None) -> Iterator["pyarrow.Table"]:
        """Rows of one block after the other, as far as they are done."""
        for block in self.done():
            yield read_table(self.rows(block), self.about, columns)

    def sweep(self) -> None:
        """Remove what processes that were killed left half written."""
        for folder in {self.path, self.lessons, *(f.parent for f in self.path.glob("*/*/.*"))}:
            sweep(folder)


def _shelf(number: int) -> str:
    return f"{number // _SHELF:04d}"


def open_folder(path: Path, campaign: Campaign, command: str) -> Folder:
    """The folder of a campaign, made where there is none.

    Raises
    ------
    RecordingError
        If it holds something else, another campaign, or was begun with other versions.
    """
    file = CampaignFile(
        SCHEMA, campaign, block_size(campaign), environment(), command, now(), git_commit()
    )
    if not (path / FILE).is_file():
        if path.is_dir() and any(p for p in path.iterdir() if not p.name.startswith(".")):
            raise RecordingError(f"{path} is no campaign's folder and not empty; give another one")
        try:
            write_text(path / FILE, to_json(file, indent=2) + "\n")
        except RecordingError:
            if not (path / FILE).is_file():  # else another process was here first
                raise
    there = load_folder(path)
    # As they are read, so that equal texts are equal values.
    wanted = from_json(to_json(campaign), Campaign, "the campaign")
    if there.campaign != wanted:
        raise RecordingError(
            f"{path} is of another campaign ({difference(there.campaign, wanted)}); give another "
            "folder, or the same command"
        )
    return there


def load_folder(path: Path) -> Folder:
    """The folder of a campaign that was begun.

    Raises
    ------
    RecordingError
        If it is none, or damaged.
    """
    where = path / FILE
    text = read_text_inside(path, FILE, limits.TEXT)
    found = from_json(text, dict, where)
    if found.get("schema") != SCHEMA:
        raise RecordingError(f"{where} has schema {found.get('schema')!s:.20}, not {SCHEMA}")
    return Folder(path, from_json(text, CampaignFile, where))


def check_versions(folder: Folder) -> None:
    """Look whether what is performed here may be mixed with what is there.

    Raises
    ------
    RecordingError
        Names what differs.
    """
    if changed := differing(folder.file.versions):
        raise RecordingError(
            f"{folder.path} was begun with other versions ({'; '.join(changed)}): bits would "
            "differ; install those, or give a new folder"
        )


def difference(one: Campaign, other: Campaign) -> str:
    """What two campaigns say differently, in words."""
    first, second = (_flat(plain(campaign)) for campaign in (one, other))
    names = [n for n in first.keys() | second.keys() if first.get(n) != second.get(n)]
    said = [f"{n} is {first.get(n)}, not {second.get(n)}" for n in sorted(names)[:3]]
    return "; ".join(said) + (f" and {len(names) - 3} more" * (len(names) > 3))


def _flat(value: object, name: str = "") -> dict[str, object]:
    if isinstance(value, Mapping):
        found: dict[str, object] = {}
        for key, part in value.items():
            found |= _flat(part, f"{name}.{key}" if name else str(key))
        return found
    return {name: value}
