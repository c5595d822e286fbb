"""The playground of a study: from the command line to the page, and back at Ctrl-C."""

import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tpsim.errors import RecordingError
from tpsim.play.clock import RealTime
from tpsim.play.lessons import Lessons
from tpsim.play.page import Page
from tpsim.play.server import Address, open_server, warn
from tpsim.play.session import Session
from tpsim.play.shelf import Shelf
from tpsim.study.study import Study
from tpsim.study.teaching import Source, demonstrations_of
from tpsim.task.verbs import Taught


@contextmanager
def playground(
    study: Study,
    address: Address,
    *,
    source: Source | None = None,
    folder: Path | None = None,
    seed: int = 0,
    command: str = "",
    apart: bool = True,
) -> Iterator[Page]:
    """Open the playground of a study for as long as the block lasts.

    Parameters
    ----------
    study : Study
    address : Address
    source : Path, Run or mapping, optional
        Demonstrations to begin with, as for :func:`tpsim.study.teaching.learn`.
    folder : Path, optional
        Where to keep what is recorded.
    seed : int
        Of the situations.
    command : str
        For people who read recordings.
    apart : bool
        Whether learning has a process of its own.
    """
    with ExitStack() as stack:
        server = open_server(address, f"tpsim · {study.task.name}")
        stack.callback(server.stop)
        given = _given(study, source)
        lessons = Lessons(study, given, apart=apart)
        stack.callback(lessons.close)
        learned = lessons.learn(study.task) if given else None
        session = Session(study, None if learned is None else learned.models, seed)
        clock = RealTime(session)
        page = Page(server, session, clock, lessons, Shelf(study.task.name, folder, command))
        stack.callback(page.close)
        if learned is not None:
            page.show(learned)
        clock.start()
        stack.callback(clock.stop)
        yield page


def play(study: Study, address: Address, **options: object) -> dict[str, object]:
    """Open the playground and wait for Ctrl-C; say where things were kept."""
    warn(address)
    with playground(study, address, **options) as page:  # type: ignore[arg-type]
        url = address.url(page.server.get_port())
        print(f"tpsim: open {url} in a browser; Ctrl-C ends it", file=sys.stderr, flush=True)
        try:
            while page.clock.is_alive():
                time.sleep(0.2)
        except KeyboardInterrupt:
            pass
        kept, pace = page.shelf.folder, page.clock.pace
        answer: dict[str, object] = {
            "task": study.task.name,
            "real_time_factor": pace.simulated / max(pace.passed, 1e-9),
        }
        if page.clock.failure is not None:
            raise page.clock.failure
    if kept.is_dir():
        answer["paths"] = {"kept": str(kept)}
    return answer


def _given(study: Study, source: Source | None) -> Taught:
    """Demonstrations to begin with; none, where there are none and none were named."""
    if source is not None:
        return demonstrations_of(study, source)
    try:
        return demonstrations_of(study, None)
    except RecordingError:
        return {}
