"""From words to a command: which command, which study, which options."""

import contextlib
import dataclasses
import io
import re
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import tyro

from tpsim.cli.campaign import CampaignCompare, CampaignFile
from tpsim.cli.commands import COMMANDS
from tpsim.cli.fields import varied, with_fields
from tpsim.cli.options import (
    Answer,
    Command,
    Learning,
    Options,
    StudyCommand,
    known,
    nearest,
)
from tpsim.cli.play import Watch, is_watched
from tpsim.cli.recordings import LearnFile
from tpsim.cli.summaries import fitted
from tpsim.errors import ArgumentError
from tpsim.tasks import STUDIES

if TYPE_CHECKING:
    from tpsim.study.study import Study

HELP = {"-h", "--help"}

SHELLS = ("bash", "zsh", "fish")

O = TypeVar("O", bound=Options)


@dataclasses.dataclass(frozen=True)
class Call:
    """A command, ready to be executed.

    Parameters
    ----------
    options : Command or StudyCommand
    line : str
        What was typed.
    study : Study, optional
        What it is about.
    """

    options: Command | StudyCommand
    line: str
    study: "Study | None" = None

    def execute(self) -> Answer:
        """Do the work and return what to print."""
        if isinstance(self.options, Command):
            return self.options.execute()
        assert self.study is not None
        return self.options.execute(self.study, self.line)


def parse(arguments: Sequence[str]) -> Call:
    """The command that ``arguments`` name, its options checked.

    Raises
    ------
    ArgumentError
        If they name an unknown command, study or option.
    SystemExit
        After help was printed.
    """
    if not arguments:
        names = ", ".join(COMMANDS)
        raise ArgumentError(f"give a command: {names}; tpsim --help describes them")
    name, *rest = arguments
    if name == "--completion":
        _complete(rest)
    known("command", name, COMMANDS)
    for before, word in zip(arguments, rest, strict=False):
        _not_empty(before, word)
    line, command = shlex.join(["tpsim", *arguments]), COMMANDS[name]
    if name == "learn" and _names_a_recording(rest):
        command = LearnFile
    if name == "campaign" and rest[:1] == ["compare"]:
        name, rest, command = "campaign compare", rest[1:], CampaignCompare
    elif name == "campaign" and rest and _names_a_campaign(rest[0]):
        command = CampaignFile
    if name == "play" and is_watched(rest):
        command = Watch
    if issubclass(command, StudyCommand):
        return _about_a_study(name, command, rest, line)
    options = _read(command, name, rest)
    options.check()
    return Call(options, line)


def _names_a_recording(words: Sequence[str]) -> bool:
    """Whether the first word is a file or folder of recordings, and no study."""
    if not words or words[0].startswith("-") or words[0] in STUDIES:
        return False
    path = Path(words[0])
    return path.exists() or (":" not in words[0] and path.suffix not in ("", ".py"))


def _names_a_campaign(word: str) -> bool:
    """Whether a word is the file that describes a campaign, or its folder."""
    return word.endswith(".json") or (Path(word) / "campaign.json").is_file()


def _about_a_study(name: str, command: type[StudyCommand], rest: list[str], line: str) -> Call:
    given = [word for word in rest if word not in HELP]
    asked = len(given) < len(rest)
    if all(word.startswith("-") for word in given):
        if asked:
            _told(command, name, ["--help"])
        raise ArgumentError(
            f"{name} TASK: give my_task.py:study, package.module:study or a built-in task "
            f"({', '.join(STUDIES)})"
        )
    first, _ = _told(command, name, given)
    if not asked:
        first.check()
    from tpsim.study.reference import load_study

    study = load_study(first.reference, STUDIES)
    if isinstance(first, Learning) and first.run is not None:
        from tpsim.study.files.run import load_run
        from tpsim.study.replay import study_of

        # The fields that the run had are the defaults of the options.
        study = study_of(load_run(first.run).check(), study)
    extended = with_fields(command, study.task)
    options = _read(extended, f"{name} {first.reference}" if asked else name, rest)
    return Call(options, line, varied(study, options))


def _read(options: type[O], name: str, words: Sequence[str]) -> O:
    """Options of a command; every word has to be understood."""
    read, unknown = _told(options, name, words)
    if unknown:
        word = next((word for word in unknown if word.startswith("--")), unknown[0])
        flags = ["--" + f.name.replace("_", "-") for f in dataclasses.fields(options)]
        # What is an argument has a name, too, and is no option.
        flags = [flag for flag in flags if flag != word.partition("=")[0]]
        if not word.startswith("-"):
            raise ArgumentError(f"{name}: unexpected {word!r}; --help lists the options")
        hint = nearest(word.partition("=")[0], flags) or "; --help lists the options"
        raise ArgumentError(f"{name}: unknown option {word!r}{hint}")
    return read


def _told(options: type[O], name: str, words: Sequence[str]) -> tuple[O, list[str]]:
    """Options out of words, and the words that are none; tyro's complaint in one line."""
    said, shown = io.StringIO(), io.StringIO()
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(shown):
            return tyro.cli(
                options,
                prog=f"tpsim {name}",
                args=list(words),
                return_unknown_args=True,
                config=(tyro.conf.SuppressFixed,),
            )
    except SystemExit as usage:
        if usage.code:
            raise ArgumentError(f"{name}: {_first_part(said.getvalue())}") from None
        print(fitted(shown.getvalue()))
        raise


def _first_part(box: str) -> str:
    """What a box of tyro says before its first line of division."""
    lines = [line.strip("│ ") for line in box.splitlines()[1:]]
    parts = re.split(r"(?:^| )[-─╰]{5,}(?: |$)", " ".join(lines))
    return next((part.strip() for part in parts if part.strip()), "")


def _not_empty(before: str, word: str) -> None:
    """An empty word is no name: as a folder it would be the current one."""
    option, equals, value = word.partition("=")
    if not word.strip():
        raise ArgumentError(f"an empty word follows {before!r}; give a value, or leave it out")
    if option.startswith("--") and equals and not value.strip():
        raise ArgumentError(f"{option} has no value; give one, or leave it out")


def _complete(words: Sequence[str]) -> None:
    """Print a script that completes commands and options, and leave."""
    shell = words[0] if len(words) == 1 else "nothing"
    if shell not in SHELLS:
        raise ArgumentError(f"--completion {shell}: give one of {', '.join(SHELLS)}")
    tyro.extras.subcommand_cli_from_dict(
        dict(COMMANDS), prog="tpsim", args=["--tyro-print-completion", shell]
    )
    sys.exit(0)
