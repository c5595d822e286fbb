"""What commands there are, in a line each: all that ``tpsim --help`` needs, imported at once."""

import shutil
import textwrap

SUMMARIES = {
    "run": "Teach, learn, reproduce, push, film and report: the whole job of a task.",
    "teach": "Lead the arms through a task and record the demonstrations.",
    "learn": "Fit the task-parameterized models to recorded demonstrations.",
    "reproduce": "Repeat the learned task in a situation that was never taught.",
    "push": "Repeat the learned task while a force acts on the robot, beside the same unpushed.",
    "campaign": "Try a task thousands of times, pushed, beside undisturbed twins; go on where it "
    "stopped.",
    "replay": "Repeat a recorded run from its own folder and compare the recordings bit for bit.",
    "export": "Write what was learned as a policy that drives a real robot without a simulator.",
    "data": "Look at a file of recordings, or convert it into another format.",
    "tune": "Tune the experts that a task is compared with, and write their gains.",
    "compare": "Measure the methods of the tutorial's Section 8, and yours, side by side.",
    "play": "Teach, push and watch a TASK in the browser; or a RUN_FOLDER, or plane, the 2-D "
    "example.",
    "bench": "Measure speeds: learning, retrieval, control, simulation, or all of them.",
    "demo": "Run a row of the tutorial's Table 2, as numbers and a picture, or list them all.",
    "robots": "List the robots at hand, or show one: limits, reach, load at home, changes.",
    "doctor": "Show versions, rendering, what is missing and the command that mends it.",
}
"""First lines of the commands' docstrings, by name."""

OTHERS = {
    "--version": "Show the version.",
    "--completion bash|zsh|fish": "Print a script that completes commands and options.",
    "-h, --help": "Show this, or after a command its options.",
}

CODES = (
    "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 done but a limit was missed (run --strict), "
    "130 interrupted."
)

_WIDEST = 100


def description() -> str:
    """The help of ``tpsim`` itself, as wide as the terminal."""
    width = min(shutil.get_terminal_size().columns, _WIDEST)
    parts = [
        "usage: tpsim COMMAND [OPTIONS]",
        *textwrap.wrap("Task-parameterized movement learning on torque-controlled robots.", width),
        "",
        *_list(SUMMARIES, width),
        "",
        *_list(OTHERS, width),
        "",
        *textwrap.wrap(CODES, width),
    ]
    return "\n".join(parts)


def fitted(text: str) -> str:
    """A page of tyro's, no wider than the terminal: its boxes are opened where they are wider."""
    width = max(20, shutil.get_terminal_size().columns)
    lines: list[str] = []
    for line in text.splitlines():
        if len(line) > width and line[:1] in ("╭", "╰"):
            line = line[: width - 1] + line[-1]
        elif len(line) > width and line[:1] == "│":
            line = line.rstrip("│ ")
        lines += textwrap.wrap(line, width) if len(line) > width else [line]
    return "\n".join(lines)


def _list(entries: dict[str, str], width: int) -> list[str]:
    column = 11
    lines = []
    for name, text in entries.items():
        first = f"  {name:<{column}}" if len(name) < column else f"  {name}\n{'':{column + 2}}"
        rest = textwrap.wrap(text, max(20, width - column - 2))
        lines += [first + rest[0], *(" " * (column + 2) + more for more in rest[1:])]
    return lines
