"""The playground of a study: from the command line to the page, and back at Ctrl-C."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from tpsim.errors import RecordingError
from tpsim.play.clock import RealTime
from tpsim.play.lessons import Lessons
from tpsim.play.server import Address, open_server, warn
from tpsim.play.session import Session
from tpsim.play.shelf import Shelf
from tpsim.study.files.run import load_run
from tpsim.study.recording import say
from tpsim.study.study import Study
from tpsim.study.teaching import Source, demonstrations_of
from tpsim.task.verbs import Taught

if TYPE_CHECKING:
    import viser

    from tpsim.play.page import Page


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
) -> Iterator["Page"]:
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
        from tpsim.play.page import Page  # needs viser, of which open_server says if it is missing

        given = _given(study, source)
        say(f"learning {study.task.name}" if given else "nothing was taught yet")
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
        _wait(address, page.server, page)
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


def watch(folder: Path, address: Address) -> dict[str, object]:
    """Show a recorded run until Ctrl-C."""
    from tpsim.play.recorded import RecordedPage

    run = load_run(folder)
    return _shown(address, folder.name, lambda server: RecordedPage(server, run))


def watch_plane(address: Address) -> dict[str, object]:
    """Show the planar example until Ctrl-C."""
    from tpsim.play.plane import Plane
    from tpsim.play.plane_page import PlanePage

    return _shown(address, "plane", lambda server: PlanePage(server, Plane()))


class Shown(Protocol):
    """A page that draws by itself."""

    def is_alive(self) -> bool:
        """Whether it still draws."""
        ...

    def close(self) -> None:
        """Stop drawing."""
        ...


def _shown(
    address: Address, name: str, make: Callable[["viser.ViserServer"], Shown]
) -> dict[str, object]:
    warn(address)
    with ExitStack() as stack:
        server = open_server(address, f"tpsim · {name}")
        stack.callback(server.stop)
        page = make(server)
        stack.callback(page.close)
        _wait(address, server, page)
    return {"watched": name}


def _wait(address: Address, server: "viser.ViserServer", page: Shown) -> None:
    """Say where the page is, and wait for Ctrl-C."""
    url = address.url(server.get_port())
    try:
        print(f"tpsim: open {url} in a browser; Ctrl-C ends it", file=sys.stderr, flush=True)
        while page.is_alive():
            time.sleep(0.2)
    except KeyboardInterrupt:
        pass


def _given(study: Study, source: Source | None) -> Taught:
    """Demonstrations to begin with; none, where there are none and none were named."""
    if source is not None:
        return demonstrations_of(study, source)
    try:
        return demonstrations_of(study, None)
    except RecordingError:
        return {}
