"""The demos: scripts with a title line and a ``main`` that returns the numbers it shows."""

import ast
import runpy
from pathlib import Path

from tpsim import paths
from tpsim.errors import TpsimError


def titles() -> dict[str, str]:
    """Return every demo's name and the first line of its docstring."""
    return {_name(script): _title(script) for script in sorted(paths.DEMOS.glob("[!_]*.py"))}


def run(name: str) -> dict:
    """Run the demo called ``name`` and return the numbers of its ``main``.

    Raises
    ------
    TpsimError
        Where the script has no ``main``.
    """
    script = next(s for s in paths.DEMOS.glob("[!_]*.py") if _name(s) == name)
    main = runpy.run_path(str(script)).get("main")
    if not callable(main):
        raise TpsimError(f"demo {name}: {script} has no function main(); give it one")
    return {"demo": name, "title": _title(script), "figures": main() or {}}


def _name(script: Path) -> str:
    """Its name in the tutorial's Table 2."""
    return script.stem


def _title(script: Path) -> str:
    lines = (ast.get_docstring(ast.parse(script.read_text())) or script.stem).splitlines()
    return lines[0]
