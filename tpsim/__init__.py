"""tpsim: task-parameterized movement learning on simulated torque-controlled robots.

The mathematics of S. Calinon, "A Tutorial on Task-Parameterized Movement Learning and
Retrieval" (2016), is here, flat; it needs numpy and scipy alone. The laboratory of simulated
robots is :mod:`tpsim.lab`.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tpsim.mathematics import *  # noqa: F403
else:

    def __getattr__(name: str) -> object:
        """Import the mathematics when it is first asked for: ``tpsim --help`` does not need it."""
        if name == "__all__":
            return __dir__()
        if not name.startswith("__"):
            if find_spec(f"tpsim.{name}") is not None:
                return import_module(f"tpsim.{name}")
            mathematics = import_module("tpsim.mathematics")
            if hasattr(mathematics, name):
                return getattr(mathematics, name)
        raise AttributeError(f"module 'tpsim' has no attribute '{name}'")


def __dir__() -> list[str]:
    """Names of the mathematics."""
    return [name for name in dir(import_module("tpsim.mathematics")) if name[0] != "_"]
