"""The gallery: the rows of the tutorial's Table 2, and its figures, as numbers and pictures.

A demo is a script in ``demos/``. Its docstring starts with its name and what it is, and says what
to look for. ``main()`` returns its figures as :class:`Bounded` numbers, ``draw(figure)`` draws its
picture, and its last line, ``present(__file__, main, draw)``, does both when it is run by itself.
"""

import ast
import contextlib
import difflib
import math
import runpy
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, SupportsFloat, TypedDict

from tpsim import paths
from tpsim.errors import ArgumentError, TpsimError
from tpsim.world.threads import one_thread

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Bounded:
    """A number that a demo shows, and the bounds in which it must lie.

    Parameters
    ----------
    value : float
    least, greatest : float
        Bounds, both included; infinite where there is none.
    reason : str
        Where the bounds come from.
    """

    value: float
    least: float
    greatest: float
    reason: str

    @property
    def holds(self) -> bool:
        """Whether the value lies in its bounds; NaN lies in none."""
        return self.least <= self.value <= self.greatest


class Shown(TypedDict):
    """One figure of a result, as plain values."""

    figure: str
    value: float
    least: float | None
    greatest: float | None
    holds: bool
    reason: str


class Result(TypedDict):
    """What running a demo gives."""

    name: str
    row: str
    look_for: str
    seconds: float
    figures: list[Shown]
    picture: str


Main = Callable[[], dict[str, Bounded]]
Draw = Callable[["Figure"], None]


def within(
    value: SupportsFloat, least: SupportsFloat, greatest: SupportsFloat, reason: str
) -> Bounded:
    """Return a number with its bounds and the reason for them, see :class:`Bounded`."""
    return Bounded(float(value), float(least), float(greatest), reason)


def folder() -> Path:
    """Return the folder that pictures are written to unless another one is given."""
    return paths.runs() / "gallery"


def titles() -> dict[str, str]:
    """Return what every demo is, by name: the rows of Table 2, then figures of the tutorial."""
    return {script.stem: _texts(script)[0] for script in _scripts()}


def run(name: str, folder: Path | None = None, *, show: bool = False) -> Result:
    """Run a demo and draw its picture.

    Parameters
    ----------
    name : str
        Its name in Table 2, one of :func:`titles`.
    folder : Path, optional
        Where the picture goes; default :func:`folder`.
    show : bool
        Open a window with the picture, and wait until it is closed.

    Raises
    ------
    ArgumentError
        Unknown name; the message gives the nearest ones.
    TpsimError
        The script has no ``main`` or no ``draw``.
    """
    scripts = {script.stem: script for script in _scripts()}
    if name not in scripts:
        raise ArgumentError(f"unknown demo {name!r}{_nearest(name, scripts)}")
    start = perf_counter()
    with _importing_from(paths.DEMOS):
        found = runpy.run_path(str(scripts[name]), run_name=name)
    for needed in ("main", "draw"):
        if not callable(found.get(needed)):
            raise TpsimError(f"demo {name}: {scripts[name]} has no function {needed}(); add it")
    return _result(scripts[name], found["main"], found["draw"], start, folder, show)


def run_all(
    folder: Path | None = None, *, progress: Callable[[str], None] = lambda name: None
) -> list[Result]:
    """Run all demos, one after the other; ``progress`` is told the name of each before it runs."""
    results = []
    for name in titles():
        progress(name)
        results.append(run(name, folder))
    return results


def brief(result: Result) -> dict[str, str | float]:
    """Return a result as one row of a table: name, seconds, figures out of bounds, picture."""
    outside = [shown["figure"] for shown in result["figures"] if not shown["holds"]]
    return {
        "name": result["name"],
        "seconds": result["seconds"],
        "out_of_bounds": ", ".join(outside) or "none",
        "picture": result["picture"],
    }


def present(script: str, main: Main, draw: Draw) -> None:
    """Print a demo's figures, write its picture and say where: the last line of every script."""
    result = _result(Path(script), main, draw, perf_counter(), None, show=False)
    print(f"{result['name']}: {result['row']}\nLook for: {result['look_for']}\n")
    width = max(len(shown["figure"]) for shown in result["figures"])
    for shown in result["figures"]:
        bounds = " to ".join(
            "-" if bound is None else f"{bound:.4g}"
            for bound in (shown["least"], shown["greatest"])
        )
        mark = "" if shown["holds"] else "  OUTSIDE"
        print(f"{shown['figure']:<{width}}  {shown['value']:<11.4g} {bounds}{mark}")
    print(f"\npicture: {result['picture']}")


@one_thread()
def _result(
    script: Path, main: Main, draw: Draw, start: float, folder_: Path | None, show: bool
) -> Result:
    from tpsim import plot

    figures = [
        Shown(
            figure=name,
            value=number.value,
            least=number.least if math.isfinite(number.least) else None,
            greatest=number.greatest if math.isfinite(number.greatest) else None,
            holds=number.holds,
            reason=number.reason,
        )
        for name, number in main().items()
    ]
    drawing = _figure(show)
    draw(drawing)
    title, look_for = _texts(script)
    picture = plot.save(drawing, (folder_ or folder()) / f"{script.stem}.png")
    result = Result(
        name=script.stem,
        row=title,
        look_for=look_for,
        seconds=round(perf_counter() - start, 3),
        figures=figures,
        picture=str(picture),
    )
    if show:
        from matplotlib import pyplot

        pyplot.show()
    return result


def _figure(show: bool) -> "Figure":
    if not show:
        from matplotlib.figure import Figure

        return Figure()
    from matplotlib import pyplot
    from matplotlib.backends.registry import BackendFilter, backend_registry

    backend = pyplot.get_backend()
    if backend in backend_registry.list_builtin(BackendFilter.NON_INTERACTIVE):
        raise ArgumentError(
            f"--show needs a display and a window toolkit (Matplotlib chose {backend!r}); "
            "leave it out and open the picture that is written"
        )
    return pyplot.figure()


def _scripts() -> list[Path]:
    """Scripts in the order of Table 2: demos, benchmarks; then figures."""
    kinds = ("demo", "benchmark", "figure")

    def place(script: Path) -> tuple[int, str]:
        kind = script.stem.split("_")[0].rstrip("0123456789")
        return kinds.index(kind) if kind in kinds else len(kinds), script.stem.lower()

    return sorted(paths.DEMOS.glob("[!_]*.py"), key=place)


def _texts(script: Path) -> tuple[str, str]:
    """Return what a demo is and what to look for, from its docstring."""
    text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or script.stem
    title, _, rest = text.partition("\n\n")
    look_for = " ".join(rest.split()).removeprefix("Look for: ")
    return " ".join(title.split()).removeprefix(f"{script.stem}: ").rstrip("."), look_for


def _nearest(name: str, names: dict[str, Path]) -> str:
    short = {_short(known): known for known in reversed(names)}
    near = difflib.get_close_matches(_short(name), short, n=3, cutoff=0.6)
    if not near:
        return "; tpsim demo lists the names"
    return f"; did you mean {' or '.join(repr(short[found]) for found in near)}?"


def _short(name: str) -> str:
    return name.lower().removeprefix("demo_").removeprefix("benchmark_").removeprefix("ds_")


@contextlib.contextmanager
def _importing_from(folder: Path) -> Iterator[None]:
    """Let scripts import their neighbours, as when they are run by themselves."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))
