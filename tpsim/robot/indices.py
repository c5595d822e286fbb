"""Where joints stand in q, by name."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.border import checked
from tpsim.checks import several, shown
from tpsim.errors import ArgumentError

LONGEST = 1000
"""Letters in the name of a joint, at most."""


@dataclass(frozen=True)
class Chain:
    """The joints that move a site, whatever they are called.

    Parameters
    ----------
    site : str
    """

    site: str

    def __post_init__(self) -> None:
        checked(self)


Names = str | tuple[str, ...] | Chain


class Indices:
    """Indices in q of the joints of a robot; each name is looked up once.

    Parameters
    ----------
    joints : tuple of str
    chain : callable
        Indices (k,) of the joints that move a site.
    """

    def __init__(self, joints: tuple[str, ...], chain: Callable[[str], np.ndarray]):
        self._joints, self._chain = joints, chain
        self._found: dict[Names, np.ndarray] = {}
        self._spans: dict[Names, slice | np.ndarray] = {}

    def find(self, joints: Names) -> np.ndarray:
        """Indices (k,) of a regular expression that matches whole names, of names, or a chain."""
        joints = _hashable(joints)
        if isinstance(joints, Chain):
            return self._found.setdefault(joints, self._chain(joints.site))
        if joints not in self._found:
            names = (joints,) if isinstance(joints, str) else joints
            found = [
                i
                for name in names
                for i, joint in enumerate(self._joints)
                if matched(name, joint, "joints")
            ]
            if not found:
                raise ArgumentError(
                    f"no joint matches {shown(joints)}; the robot has {self._joints}"
                )
            self._found[joints] = np.array(found)
        return self._found[joints]

    def span(self, joints: Names) -> slice | np.ndarray:
        """The same indices as a slice, where they follow each other."""
        try:
            found = self._spans.get(joints)
        except TypeError:
            found = None
        if found is None:
            joints = _hashable(joints)
            found = self._spans[joints] = as_slice(self.find(joints))
        return found


def _hashable(joints: Names) -> Names:
    if isinstance(joints, str | Chain):
        return joints
    return tuple(several("joints", joints, str))


def as_slice(indices: Sequence[int] | np.ndarray) -> slice | np.ndarray:
    """Indices (k,) as a slice, where they follow each other: it selects a view, and faster."""
    first = int(indices[0])
    if np.array_equal(indices, np.arange(first, first + len(indices))):
        return slice(first, first + len(indices))
    return np.asarray(indices)


def matched(pattern: str, joint: str, argument: str) -> bool:
    """Whether a joint has this name, or matches this regular expression as a whole.

    Raises
    ------
    ArgumentError
        If the pattern is no regular expression.
    """
    if len(pattern) > LONGEST:
        raise ArgumentError(
            f"{argument} has a name of {len(pattern)} letters; give at most {LONGEST}"
        )
    if pattern == joint:
        return True
    try:
        return re.fullmatch(pattern, joint) is not None
    except re.error as error:
        raise ArgumentError(
            f"{argument} names '{pattern}', which is no joint and no regular expression: {error}"
        ) from None
