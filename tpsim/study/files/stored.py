"""A recorded trial of which only the names are in memory: its signals are read when asked for."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from tpsim.study.files.trial_file import load_trial
from tpsim.world.trial import Channels, Trial

V = TypeVar("V")


@dataclass(frozen=True)
class Stub:
    """What is kept of a trial whose recording is in a file: it is small, and travels.

    Parameters
    ----------
    path : Path
        Of the recording.
    names, about : tuple of str
        Of the signals, and of what the trial says about itself.
    outcome : str
    channels : Channels
    """

    path: Path
    names: tuple[str, ...]
    about: tuple[str, ...]
    outcome: str
    channels: Channels

    @classmethod
    def of(cls, trial: Trial, path: Path) -> "Stub":
        """What is kept of a trial that was saved to ``path``."""
        return cls(path, tuple(trial.arrays), tuple(trial.about), trial.outcome, trial.channels)

    def trial(self) -> Trial:
        """The trial; its signals are read from the file one by one, whenever they are asked for."""
        arrays = _Later(self.names, self._read)
        about = _Later(self.about, lambda name: load_trial(self.path).about[name])
        return Trial(arrays, self.outcome, self.channels, about)

    def _read(self, name: str) -> np.ndarray:
        with np.load(self.path, allow_pickle=False) as file:
            array: np.ndarray = file[name]
        return array


class _Later(Mapping[str, V]):
    """Values by name, each read when it is asked for and not kept."""

    def __init__(self, names: tuple[str, ...], read: Callable[[str], V]):
        self._names, self._read = names, read

    def __getitem__(self, name: str) -> V:
        if name not in self._names:
            raise KeyError(name)
        return self._read(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
