"""Where joints stand in q, by name."""

import re
from collections.abc import Sequence

import numpy as np

from tpsim.errors import ArgumentError

Names = str | tuple[str, ...]


class Indices:
    """Indices in q of the joints of a robot; each name is looked up once."""

    def __init__(self, joints: tuple[str, ...]):
        self._joints = joints
        self._found: dict[Names, np.ndarray] = {}
        self._spans: dict[Names, slice | np.ndarray] = {}

    def find(self, joints: Names) -> np.ndarray:
        """Indices (k,) of a regular expression that matches whole names, or of names."""
        if joints not in self._found:
            names = (joints,) if isinstance(joints, str) else joints
            found = [
                i
                for name in names
                for i, joint in enumerate(self._joints)
                if joint == name or re.fullmatch(name, joint)
            ]
            if not found:
                raise ArgumentError(f"no joint matches {joints!r}; the robot has {self._joints}")
            self._found[joints] = np.array(found)
        return self._found[joints]

    def span(self, joints: Names) -> slice | np.ndarray:
        """The same indices as a slice, where they follow each other."""
        if joints not in self._spans:
            self._spans[joints] = as_slice(self.find(joints))
        return self._spans[joints]


def as_slice(indices: Sequence[int] | np.ndarray) -> slice | np.ndarray:
    """Indices (k,) as a slice, where they follow each other: it selects a view, and faster."""
    first = int(indices[0])
    if np.array_equal(indices, np.arange(first, first + len(indices))):
        return slice(first, first + len(indices))
    return np.asarray(indices)
