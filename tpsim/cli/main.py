"""The command line: parse, run one command, print its results, turn errors into one line.

A command returns a plain dictionary. That dictionary is what ``--json`` prints, and the human
summary is made from it. Standard output carries nothing else; progress and notes go to standard
error. What is heavy is imported when signals are listened to, and only where it is needed.
"""

import os
import sys
from collections.abc import Sequence

from tpsim.cli import stopping

_LONGEST = 800
"""Most letters of an error: names can be as long as a screen."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command line, by default that of this process.

    Returns
    -------
    int
        0 done, 1 the work failed, 2 wrong usage, 3 done but a figure misses its limit (run
        --strict), 130 interrupted (129 by the end of its terminal, 143 by SIGTERM).
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    with stopping.listening(for_good=arguments is None):
        try:
            return _main(words)
        except BaseException as error:
            if not (stopping.stopped() or isinstance(error, KeyboardInterrupt)):
                raise
            code = stopping.tell(error, _again(words))
            if arguments is None:
                os._exit(code)  # what Python does at its end takes long, and is not needed
            return code


def _main(words: list[str]) -> int:
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # small matrices: BLAS threads only hurt
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")  # a terminal may lack letters
    from tpsim.errors import ArgumentError, TpsimError, one_line, place

    try:
        return _answered(words)
    except ArgumentError as error:
        return _fail(one_line(error), 2)
    except TpsimError as error:
        return _fail(one_line(error), 1)
    except OSError as error:
        return _fail(_of_the_system(error), 1)
    except MemoryError:
        return _fail("there is not enough memory for this", 1)
    except Exception as error:
        if stopping.stopped() or (where := place(error)) is None:
            raise
        return _fail(f"{where}: {type(error).__name__}: {one_line(error)}", 1)


def _answered(words: list[str]) -> int:
    """Do what the words say; errors are the caller's."""
    from tpsim.cli.summaries import description

    if words in (["-h"], ["--help"]):
        return _print(description())
    if words == ["--version"]:
        from importlib.metadata import version

        return _print(f"tpsim {version('tpsim')}")
    import contextlib

    from tpsim.cli.parse import parse
    from tpsim.film import rendering

    rendering.name_glfw()
    if told := rendering.disarm():
        print(f"tpsim: {told}", file=sys.stderr)
    try:
        call = parse(words)
    except SystemExit as usage:
        return int(usage.code or 0)
    try:
        with contextlib.redirect_stdout(sys.stderr):
            answer = call.execute()
    except SystemExit as left:
        return _fail(f"code of the study ended the program with sys.exit({left.code!r})", 1)
    from tpsim.study.summary import plain, summary

    if call.options.json:
        import json

        _print(json.dumps(plain(answer), allow_nan=False))
    else:
        _print(summary(answer))
    return call.options.exit_code(answer)


def _print(text: str) -> int:
    try:
        print(text)
        sys.stdout.flush()
    except BrokenPipeError:
        # Who reads, has read enough; Python must not complain once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return 0


def _of_the_system(error: OSError) -> str:
    """An error of files: which file, and what is wrong with it."""
    from tpsim.errors import one_line

    if error.strerror and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: {error.strerror}"
    return one_line(error)


def _again(words: list[str]) -> str:
    import shlex

    return shlex.join(["tpsim", *words])


def _fail(message: str, code: int) -> int:
    if len(message) > _LONGEST:
        message = f"{message[: _LONGEST - 150]} ... {message[-150:]}"
    print(f"tpsim: {message}", file=sys.stderr)
    return code
