"""The equation index: every numbered equation of the tutorial, its functions, tests and demos.

Nothing is written down twice: a function stands beside an equation because its docstring names the
number, a test because it calls that function, a demo because its docstring names the number or it
calls that function. What has no function stands in :data:`NOT_IN_CODE` with the reason.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path

import gallery_pages
from reference import PAGES, ROOMS, listed

ROOT = Path(__file__).resolve().parents[2]
LAST = 80

SECTIONS = {
    "Section 2.2: a single Gaussian": (1, 3),
    "Section 3: TP-GMM": (4, 6),
    "Section 3.1: regularisation": (7, 8),
    "Section 4: subspaces": (9, 11),
    "Section 5.1: Gaussian mixture regression": (12, 20),
    "Section 5.2: dynamic features": (21, 32),
    "Section 6: linear quadratic tracking": (33, 38),
    "Section 7: projection constraints (Table 3)": (39, 44),
    "Section 8: other methods": (45, 48),
    "Appendix A: EM for TP-GMM": (49, 52),
    "Appendix B: EM for TP-MFA and TP-MPPCA": (53, 68),
    "Appendix C: GMR as one Gaussian": (69, 75),
    "Appendix D: EM for parametric GMM": (76, 80),
}
"""Where the tutorial has its equations: first and last number."""

_MENTION = re.compile(
    r"\bEqs?\.?\s*(\(?\d+\)?(?:(?:\s*(?:-|–|to|and|or|,))+\s*\(?\d+\)?(?![\d.]*\s*(?:s\b|m\b)))*)"
)
_MISUSE = re.compile("refuse|misuse|wrong|bad|error|needs")
_AGAINST = re.compile(
    "recover|never|reference|dense|closed_form|by_hand|eq_|table_3|minimise|equals|likel|product|are_those"
)
_RANGE = re.compile(r"\(?(\d+)\)?(?:\s*(?:-|–|to)\s*\(?(\d+)\)?)?")


def numbers(text: str) -> set[int]:
    """Equations that a text names, as in "Eq. 4", "Eqs (5-6)", "Eqs 12-19 and 75"."""
    found: set[int] = set()
    for mention in _MENTION.findall(text):
        for first, last in _RANGE.findall(mention):
            found.update(range(int(first), int(last or first) + 1))
    return {number for number in found if 1 <= number <= LAST}


@dataclass(frozen=True)
class Definition:
    """A function, class or constant of the package, and the equations that its docstring names."""

    module: str
    name: str
    line: int
    says: frozenset[int]
    """Equations of the first paragraph: what it is."""
    also: frozenset[int]
    """Equations of the rest: what it uses."""
    public: str | None = None
    """The name by which users call it, where there is one."""


@dataclass(frozen=True)
class Entry:
    """One equation of the index."""

    number: int
    functions: tuple[Definition, ...] = ()
    tests: tuple[str, ...] = ()
    demos: tuple[str, ...] = ()


NOT_IN_CODE = {
    53: "the generative model from which Eqs (57-63) follow; nothing draws from it in this form, "
    "samples come from the covariance of Eq. (11)",
    55: "the joint distribution of data and factors, a step of the derivation of Eq. (56)",
    56: "the expected factors, a step of the derivation: what is used of it is the matrix B, "
    "Eq. (63), inside EM",
    69: "Bayes' rule, the first step of the derivation of Eq. (13)",
    70: "a step of the derivation; its result is Eq. (13)",
    71: "a step of the derivation; its result is Eq. (18)",
    72: "the definition of a covariance, a step of the derivation of Eq. (75)",
    73: "a step of the derivation of Eq. (75)",
    74: "a step of the derivation of Eq. (75)",
}
"""Equations that no function stands for, and why."""

ELSEWHERE = ("tasks", "data", "section8", "cli", "bench", "study", "task")
"""Rooms that use the mathematics and define no equation."""


@cache
def definitions() -> tuple[Definition, ...]:
    """Everything in the package whose docstring names an equation."""
    public = _public()
    found = []
    for file in sorted((ROOT / "tpsim").rglob("*.py")):
        if file.relative_to(ROOT).parts[1] in ELSEWHERE:
            continue
        module = ".".join(file.relative_to(ROOT).with_suffix("").parts)
        for name, node in _named(ast.parse(file.read_text(encoding="utf-8"))):
            first, _, rest = (ast.get_docstring(node) or "").partition("\n\n")
            says, also = numbers(first), numbers(rest)
            if says or also:
                place = getattr(node, "lineno", 1)
                known = public.get((module, name))
                found.append(
                    Definition(module, name, place, frozenset(says), frozenset(also), known)
                )
    return tuple(found)


@cache
def index() -> tuple[Entry, ...]:
    """The index, one entry for every equation of the tutorial."""
    return tuple(_entry(number) for number in range(1, LAST + 1))


def page() -> str:
    """The index as Markdown, a table for every section of the tutorial."""
    entries, lines = index(), []
    for title, (first, last) in SECTIONS.items():
        lines += [
            f"## {title}",
            "",
            "| Eq. | functions | tests | demos |",
            "| --- | --- | --- | --- |",
        ]
        lines += [_row(entries[number - 1]) for number in range(first, last + 1)]
        lines.append("")
    return "\n".join(lines)


def _row(entry: Entry) -> str:
    number = f"[]{{#eq-{entry.number}}}({entry.number})"
    if not entry.functions:
        return f"| {number} | *not in the code:* {NOT_IN_CODE[entry.number]} | | |"
    functions = "<br>".join(_link(function) for function in entry.functions)
    tests = "<br>".join(_said(*test.split("::")) for test in entry.tests)
    demos = "<br>".join(f"{{doc}}`{demo} <{gallery_pages.page(demo)}>`" for demo in entry.demos)
    return f"| {number} | {functions} | {tests} | {demos} |"


def _said(file: str, name: str) -> str:
    """A test as a sentence, with its file."""
    return f"{name.removeprefix('test_').replace('_', ' ')} (`{file.removeprefix('tests/')}`)"


def _link(function: Definition) -> str:
    if not function.public:
        return f"`{function.module}.{function.name}`"
    return f"{{py:obj}}`{function.public.removeprefix('tpsim.')} <{_documented(function.public)}>`"


def _documented(public: str) -> str:
    """Where the reference documents a name: a method that is inherited stands with its class."""
    owner, _, name = public.rpartition(".")
    kind = dict(pair for page in PAGES for pair in listed(page)).get(owner)
    own = kind is None or (name in vars(kind) and not name.startswith("__"))
    return public if own else owner


def _entry(number: int) -> Entry:
    """Functions that say the number first, public ones where there are any."""
    for wanted in (lambda d: number in d.says, lambda d: number in d.also):
        named = [d for d in definitions() if wanted(d)]
        chosen = [d for d in named if d.public] or named
        if chosen:
            break
    else:
        return Entry(number)
    functions = tuple(sorted(chosen, key=_closeness))
    return Entry(number, functions, _tests(number, functions), _demos(number, functions))


def _closeness(function: Definition) -> tuple[bool, int, str]:
    """Mathematics before robots, functions of few equations before those of many."""
    return function.module.startswith("tpsim.robot"), len(function.says), function.module


def _tests(number: int, functions: tuple[Definition, ...], most: int = 2) -> tuple[str, ...]:
    """Tests that call one of the functions: those that name the equation or its file first."""
    calls = {_called(function): function for function in functions}
    ranked = []
    for file, name, used, says in _all_tests():
        for call in used & calls.keys():
            home = file.endswith(f"test_{calls[call].module.split('.')[-1]}.py")
            words = bool(_MISUSE.search(name)), not _AGAINST.search(name)
            place = f"{file}::{name}"
            ranked.append((words[0], number not in says, not home, words[1], len(used), place))
    return tuple(dict.fromkeys(test for *_, test in sorted(ranked)))[:most]


def _demos(number: int, functions: tuple[Definition, ...], most: int = 4) -> tuple[str, ...]:
    """Demos that name the equation, or else call one of its functions by its public name."""
    calls = {_called(function) for function in functions if function.public}
    said = [name for name, _, says in _all_demos() if number in says]
    return tuple(said or [name for name, used, _ in _all_demos() if used & calls])[:most]


def _called(function: Definition) -> str:
    """Name by which code calls a function; that of its class for what Python calls itself."""
    *_, owner, name = ("", *function.name.split("."))
    return owner if name.startswith("__") else name


@cache
def _all_tests() -> tuple[tuple[str, str, frozenset[str], frozenset[int]], ...]:
    """File, name, names used, and equations named, of every test."""
    found = []
    for file in sorted((ROOT / "tests").rglob("test_*.py")):
        source = file.read_text(encoding="utf-8")
        tree = ast.parse(source)
        shared = {name: _used(node) for node in tree.body for name in _makes(node)}
        subject = numbers(ast.get_docstring(tree) or "")
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                text = "\n".join(source.splitlines()[node.lineno - 1 : node.end_lineno])
                place, used = file.relative_to(ROOT).as_posix(), _used(node)
                used = used.union(*(shared[name] for name in used & shared.keys()))
                found.append((place, node.name, used, frozenset(numbers(text) or subject)))
    return tuple(found)


def _makes(node: ast.stmt) -> Iterator[str]:
    """Names that a test file shares among its tests: helpers and constants."""
    if isinstance(node, ast.FunctionDef):
        yield node.name
    elif isinstance(node, ast.Assign):
        yield from (target.id for target in node.targets if isinstance(target, ast.Name))


@cache
def _all_demos() -> tuple[tuple[str, frozenset[str], frozenset[int]], ...]:
    """Name, names used, and equations named, of every demo."""
    found = []
    for file in sorted((ROOT / "demos").glob("[!_]*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        says = numbers(ast.get_docstring(tree) or "")
        found.append((file.stem, _used(tree), frozenset(says)))
    return tuple(found)


def _used(tree: ast.AST) -> frozenset[str]:
    return frozenset(
        node.id if isinstance(node, ast.Name) else node.attr
        for node in ast.walk(tree)
        if isinstance(node, (ast.Name, ast.Attribute))
    )


def _named(tree: ast.Module, inside: str = "") -> Iterator[tuple[str, ast.AST]]:
    """Functions, classes and methods, with their qualified names; private ones stay inside."""
    for node in getattr(tree, "body", []):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            name = f"{inside}{node.name}"
            if not node.name.startswith("_") or node.name.startswith("__"):
                yield name, node
                if isinstance(node, ast.ClassDef):
                    yield from _named(node, f"{name}.")


@cache
def _public() -> dict[tuple[str, str], str]:
    """Public names by where they are defined: functions, classes, and methods of classes."""
    found: dict[tuple[str, str], str] = {}
    for room in ROOMS:
        module = import_module(room.module)
        for name in room.names:
            value = getattr(module, name)
            where, inside = getattr(value, "__module__", ""), getattr(value, "__qualname__", name)
            found.setdefault((where, inside), f"{room.prefix}.{name}")
            for parent in reversed(getattr(value, "__mro__", ())):
                for method in vars(parent):
                    key = (parent.__module__, f"{parent.__qualname__}.{method}")
                    if parent is value or key not in found:
                        found[key] = f"{room.prefix}.{name}.{method}"
    return found
