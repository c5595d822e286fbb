"""One damaged folder, tried in a process of its own with little memory and little time."""

import os
import pickle
import resource
import select
import shutil
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path

from tpsim.errors import TpsimError

from .tamper import Change

MEMORY = 2**31
"""Bytes that reading may take beyond what the process has."""

SECONDS = 20

Use = Callable[[Path], str]
"""Reads a folder; returns how that went, or raises."""


class Ledger:
    """What became of all cases of a subject."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.failures: list[str] = []

    def __str__(self) -> str:
        words = ", ".join(f"{number} {word}" for word, number in sorted(self.counts.items()))
        return f"{self.counts.total()} folders: {words}; {len(self.failures)} failures"


def judge(
    original: Path,
    cases: Iterable[tuple[str, Change]],
    use: Use,
    space: Path,
    *,
    silent: bool = False,
) -> Ledger:
    """Damage copies of a folder, one after the other, and use each.

    Parameters
    ----------
    original : Path
    cases : iterable of (str, callable)
    use : callable
    space : Path
        Where the copies are.
    silent : bool
        Whether a change that nobody notices is one that nobody can notice.
    """
    ledger, before = Ledger(), _digest(original)
    for what, change in cases:
        shutil.rmtree(space, ignore_errors=True)
        space.mkdir()
        copy = space / "copy" / original.name
        shutil.copytree(original, copy)
        change(copy)
        if not any(p.is_fifo() or p.is_symlink() for p in copy.rglob("*")) and (
            _digest(copy) == before
        ):
            continue
        began = time.monotonic()
        word, why = tried(use, copy)
        if word == "as before" and not silent:
            word, why = "SILENT", "nobody noticed"
        ledger.counts[word] += 1
        if word.isupper():
            ledger.failures.append(f"{what}: {word}: {why} ({time.monotonic() - began:.1f} s)")
    return ledger


def tried(use: Use, copy: Path) -> tuple[str, str]:
    """How a use ended: a small word where all is well, capitals where not; and why."""
    sys.stdout.flush()
    ours, theirs = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(ours)
        _child(use, copy, theirs)
    os.close(theirs)
    ready, _, _ = select.select([ours], [], [], SECONDS)
    said = b""
    if ready:
        while part := os.read(ours, 1 << 16):
            said += part
    else:
        os.kill(child, signal.SIGKILL)
    os.close(ours)
    _, status = os.waitpid(child, 0)
    if not ready:
        return "HANGS", f"after {SECONDS} s"
    if not said:
        return "DIES", f"status {status}"
    word, why = pickle.loads(said)
    return word, why


def _child(use: Use, copy: Path, pipe: int) -> None:
    silence = os.open(os.devnull, os.O_RDWR)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    warnings.simplefilter("ignore")
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    try:
        answer = use(copy), ""
    except TpsimError as error:
        line = str(error)
        answer = ("refused", line) if "\n" not in line and line else ("LINES", line)
        if len(line) > 2000:
            answer = "LONG", line[:200]
    except BaseException as error:
        steps = [
            f"{Path(s.filename).name}:{s.lineno}" for s in traceback.extract_tb(error.__traceback__)
        ]
        answer = "FOREIGN", f"{type(error).__name__}: {error!s:.200} [{' '.join(steps[-6:])}]"
    os.write(pipe, pickle.dumps(answer)[: 1 << 15])
    os._exit(0)


def _digest(folder: Path) -> str:
    found = sha256()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not path.is_symlink():
            found.update(f"{path.relative_to(folder)} {path.stat().st_size} ".encode())
            found.update(path.read_bytes())
    return found.hexdigest()
