"""Studies by name: ``my_task.py:study``, ``package.module:study``, ``cup-and-sugar``."""

import importlib
import importlib.util
import re
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path
from types import ModuleType

import cloudpickle

from tpsim.border import border
from tpsim.checks import shown
from tpsim.errors import ArgumentError, TpsimError, one_line
from tpsim.study.study import Study
from tpsim.task.task import Task

NAME = "study"
"""Looked for where a reference names a file or module alone."""


@border
def load_study(reference: str, names: Mapping[str, str] | None = None) -> Study:
    """The study that a reference names.

    Parameters
    ----------
    reference : str
        ``"file.py:name"``, ``"package.module:name"``, or one of ``names``. The object may be a
        study, a task (whose study is then a plain one), or a function without arguments that
        returns one of them; ``study`` by default.
    names : mapping of str to str, optional
        Short names, such as :data:`tpsim.tasks.STUDIES`.

    Returns
    -------
    Study
        Its ``reference`` says where it is from, short names in full.

    Raises
    ------
    ArgumentError
        If there is no such file, module or name, or the file does not import; one line.
    """
    known = dict(names or {})
    full = known.get(reference, reference)
    source, _, name = full.rpartition(":") if ":" in full else (full, "", NAME)
    if source.endswith(".py"):
        module = _of_file(Path(source))
    elif re.fullmatch(r"[A-Za-z_]\w*(\.\w+)*", source) and (":" in full or "." in source):
        module = _of_module(source)
    else:
        raise ArgumentError(_unknown(reference, known))
    return replace(_found(module, name, source), reference=f"{source}:{name}")


def is_ours(reference: str) -> bool:
    """Whether a reference names a study that tpsim itself brings."""
    return bool(re.fullmatch(r"tpsim\.tasks(\.[a-z_]+)*\.study:[a-z][a-z_]*", reference))


def _unknown(reference: str, known: Mapping[str, str]) -> str:
    near = get_close_matches(reference, known, 1)
    hint = f"did you mean {near[0]}? " if near else ""
    choices = f"one of {', '.join(known)}, " if known else ""
    return (
        f"there is no study {shown(reference)}; {hint}give {choices}my_task.py:study or "
        "package.module:study"
    )


def _of_file(path: Path) -> ModuleType:
    """Import a file under its own name, its folder on the path as for ``python file.py``."""
    if not path.is_file():
        raise ArgumentError(f"there is no file {path}; give the study's file, as my_task.py:study")
    folder = str(path.resolve().parent)
    if folder not in sys.path:
        sys.path.append(folder)
    known = sys.modules.get(path.stem)
    taken = known is not None and getattr(known, "__file__", None) != str(path.resolve())
    name = f"_study_{path.stem}" if taken or path.stem in sys.stdlib_module_names else path.stem
    spec = importlib.util.spec_from_file_location(name, path.resolve())
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Dataclasses and pickles look a class's module up by its name.
    sys.modules[name] = module
    loader = spec.loader
    try:
        _importing(str(path), lambda: loader.exec_module(module))
    except BaseException:
        del sys.modules[name]
        raise
    # Workers cannot import it: it travels by value.
    cloudpickle.register_pickle_by_value(module)
    return module


def _of_module(name: str) -> ModuleType:
    folder = str(Path.cwd())
    if folder not in sys.path:
        sys.path.append(folder)
    found: list[ModuleType] = []
    _importing(f"module {name}", lambda: found.append(importlib.import_module(name)))
    return found[0]


def _importing(what: str, work: Callable[[], None]) -> None:
    """Import, and say in one line what fails and where."""
    try:
        work()
    except TpsimError as error:
        raise ArgumentError(f"{what} does not import{_line_of(error)}: {error}") from error
    except (Exception, SystemExit) as error:
        reason = one_line(error)
        raise ArgumentError(
            f"{what} does not import{_line_of(error)}: {type(error).__name__}: {reason}"
        ) from error


def _line_of(error: BaseException) -> str:
    """Where an import failed: the innermost line outside the import machinery and tpsim."""
    if isinstance(error, SyntaxError):
        return f" ({Path(error.filename or '').name}, line {error.lineno})"
    ours = str(Path(__file__).parents[1])
    steps = [
        step
        for step in traceback.extract_tb(error.__traceback__)
        if not step.filename.startswith(("<frozen", ours)) and "importlib" not in step.filename
    ]
    return f" ({Path(steps[-1].filename).name}, line {steps[-1].lineno})" if steps else ""


def _found(module: ModuleType, name: str, source: str) -> Study:
    if not hasattr(module, name):
        there = [n for n, value in vars(module).items() if isinstance(value, Study | Task)]
        listed = ", ".join(there) or "no study at all: write study = Study(...)"
        raise ArgumentError(f"{source} has no '{name}'; it has {listed}")
    value = getattr(module, name)
    if (isinstance(value, type) and issubclass(value, Task)) or callable(value):
        try:
            value = value()
        except TypeError as error:
            raise ArgumentError(
                f"{source}:{name} cannot be called without arguments ({error}); name a Study, a "
                "Task, or a function that returns one"
            ) from error
    if isinstance(value, Task):
        return Study(value)
    if not isinstance(value, Study):
        raise ArgumentError(
            f"{source}:{name} is of type {type(value).__name__}; name a Study, a Task, or a "
            "function that returns one"
        )
    return value
