"""The command line: parse, run one command, print its results, turn errors into one line.

A command returns a plain dictionary. That dictionary is what ``--json`` prints, and the human
summary is made from it. Standard output carries nothing else; progress and notes go to standard
error.
"""

import contextlib
import json
import os
import shlex
import sys
import traceback
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from tpsim.cli.options import Answer
from tpsim.cli.parse import parse
from tpsim.errors import ArgumentError, TpsimError
from tpsim.paths import runs


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line; return 0 done, 1 the work failed, 2 wrong usage."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    if arguments == ["--version"]:
        print(f"tpsim {version('tpsim')}")
        return 0
    try:
        call = parse(arguments)
        with contextlib.redirect_stdout(sys.stderr):
            answer = call.execute()
    except SystemExit as usage:
        return int(usage.code or 0)
    except ArgumentError as error:
        return _fail(error, 2)
    except (TpsimError, OSError) as error:
        return _fail(error, 1)
    except Exception as error:
        if (place := _of_the_user(error)) is None:
            raise
        return _fail(f"{place}: {type(error).__name__}: {error}", 1)
    except KeyboardInterrupt:
        again = shlex.join(["tpsim", *arguments])
        return _fail(
            f"interrupted; finished trials are kept in {runs()}. To start again: {again}", 1
        )
    try:
        _show(answer, as_json=call.options.json)
        sys.stdout.flush()
    except BrokenPipeError:
        # Who reads, has read enough; Python must not complain once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0 if call.options.succeeded(answer) else 1


def _of_the_user(error: Exception) -> str | None:
    """Where a user's own code went wrong; None where it was ours."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    if Path(last.filename).is_relative_to(Path(__file__).parents[1]):
        return None
    if "site-packages" in last.filename or last.filename.startswith("<"):
        return None
    return f"{last.filename}, line {last.lineno}, in {last.name}"


def _show(answer: Answer, *, as_json: bool) -> None:
    from tpsim.study.summary import plain, summary

    print(json.dumps(plain(answer), allow_nan=False) if as_json else summary(answer))


def _fail(message: object, code: int) -> int:
    print("tpsim: " + " ".join(str(message).split()), file=sys.stderr)
    return code
