"""The progress page of a campaign: how far it is and what came out so far, in a browser."""

import time
from datetime import timedelta

from tpsim.campaign import report
from tpsim.campaign.folder import Folder
from tpsim.study.report import Section, write_report
from tpsim.study.study import Study
from tpsim.whole import write_text

NAME = "progress.html"
"""Of the page, in the campaign's folder."""

_PERIOD = 5.0
"""Time [s] between two pages at least, and between two looks of a browser."""

_SHARE = 0.05
"""Of this process's time that pages may take."""

_TEXT = (
    "Made from the finished blocks of all processes and shards. A browser loads this page again "
    "every few seconds, and goes on to the report when all trials are done."
)
_DONE = '<!doctype html>\n<meta http-equiv="refresh" content="0; url=report.html">\n'


class ProgressPage:
    """Writes the page while trials are performed.

    Parameters
    ----------
    folder : Folder
    study : Study
    """

    def __init__(self, folder: Folder, study: Study):
        self._folder = folder
        self._title = study.title or study.task.name
        self._began, self._at_first = time.monotonic(), 0
        self._next = 0.0
        self._write()

    def update(self) -> None:
        """Write the page, if it is time to."""
        if time.monotonic() >= self._next:
            self._write()

    def _write(self) -> None:
        began = time.monotonic()
        found = report.status(self._folder)
        trials, done, failed, cells = map(found.get, ("trials", "done", "failed", "cells"))
        assert isinstance(trials, int) and isinstance(done, int) and isinstance(failed, int)
        ready = done + failed
        if not self._next:
            self._at_first = ready
        write_report(
            self._folder.path / NAME,
            title=f"{self._title}: {ready} of {trials} trials",
            command=self._folder.file.command,
            sections=[Section("So far", _TEXT, table=cells if isinstance(cells, list) else ())],
            no_film="",
            about={
                "done": done,
                "failed": failed,
                "percent": round(100 * ready / trials, 1),
                "at": time.strftime("%H:%M:%S"),
                **self._left(ready, trials),
            },
            refresh=f"{_PERIOD:.0f}",
        )
        took = time.monotonic() - began
        self._next = began + max(_PERIOD, took / _SHARE)

    def _left(self, ready: int, trials: int) -> dict[str, str]:
        """How long it still takes at the pace so far, of all processes that write here."""
        new = ready - self._at_first
        if not new or ready >= trials:
            return {}
        seconds = (time.monotonic() - self._began) * (trials - ready) / new
        return {"left, about": str(timedelta(seconds=round(seconds)))}


def arrive(folder: Folder) -> None:
    """Let browsers that look at the page go on to the report."""
    write_text(folder.path / NAME, _DONE, replace=True)
