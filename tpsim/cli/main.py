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
from collections.abc import Sequence

from tpsim import paths
from tpsim.commands import parse
from tpsim.errors import ArgumentError, TpsimError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line; return 0 done, 1 the work failed, 2 wrong usage."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # small matrices: BLAS threads only hurt
    try:
        command = parse(arguments)
    except SystemExit as usage:
        return int(usage.code or 0)
    try:
        command.check()
        with contextlib.redirect_stdout(sys.stderr):
            result = command.execute()
    except ArgumentError as error:
        return _fail(error, 2)
    except (TpsimError, OSError) as error:
        return _fail(error, 1)
    except KeyboardInterrupt:
        again = shlex.join(["tpsim", *arguments])
        return _fail(
            f"interrupted; finished trials are kept in {paths.runs()}. To start again: {again}", 1
        )
    try:
        _show(result, as_json=command.json)
        sys.stdout.flush()
    except BrokenPipeError:
        # Who reads, has read enough; Python must not complain once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def _show(result: dict, *, as_json: bool) -> None:
    from tpsim.experiment.summary import plain, summary

    print(json.dumps(plain(result), allow_nan=False) if as_json else summary(result))


def _fail(message: object, code: int) -> int:
    print("tpsim: " + " ".join(str(message).split()), file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
