"""Which offscreen renderer works on this machine.

Importing mujoco with a ``MUJOCO_GL`` that does not work can fail, so the variable is never set to
a renderer in this process: each candidate is tried in a process of its own, and films are drawn in
workers.
"""

import functools
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from tpsim.errors import RenderingError, one_line

VARIABLE = "MUJOCO_GL"
"""Environment variable that names mujoco's renderer."""

LIBRARY = "PYGLFW_LIBRARY"
"""Environment variable that names the library that glfw loads."""

BACKENDS = {"linux": ("egl", "osmesa"), "darwin": ("cgl",), "win32": ("wgl",)}
"""Values of ``MUJOCO_GL`` that draw without a window, by ``sys.platform``."""

HINT = (
    "no offscreen rendering here: apt-get install -y --no-install-recommends"
    " libegl1 libegl-mesa0 libgl1-mesa-dri libgl1 libgles2"
)
"""What to do where no renderer works, in one line."""

_PROBE = """
import mujoco
model = mujoco.MjModel.from_xml_string("<mujoco/>")
with mujoco.Renderer(model, 16, 16) as renderer:
    renderer.update_scene(mujoco.MjData(model))
    renderer.render()
"""


@functools.cache
def backend() -> str | None:
    """Return the value of ``MUJOCO_GL`` that draws here, or None; probed once per process."""
    candidates = BACKENDS.get(sys.platform, BACKENDS["linux"])
    return next((name for name in candidates if _draws(name)), None)


def environment() -> dict[str, str]:
    """Return the environment variables of a process that draws.

    Raises
    ------
    RenderingError
        If nothing draws here; the message names the packages to install.
    """
    name = backend()
    if name is None:
        raise RenderingError(HINT)
    return {**os.environ, VARIABLE: name}


def name_glfw() -> None:
    """Name the library that comes with glfw's package, where the user named none.

    mujoco imports glfw, whose own search starts Python twice; these processes print a traceback
    each when the one that started them dies meanwhile, as workers and stopped commands do.
    """
    found = find_spec("glfw")
    if found is None or found.origin is None or LIBRARY in os.environ:
        return
    windows = os.environ.get("PYGLFW_LIBRARY_VARIANT") or os.environ.get("XDG_SESSION_TYPE")
    variant = "wayland" if str(windows).lower() == "wayland" else "x11"
    file = Path(found.origin).parent / variant / "libglfw.so"
    if file.exists():
        os.environ[LIBRARY] = str(file)


def disarm() -> str | None:
    """Let mujoco be imported also where ``MUJOCO_GL`` names a renderer that does not work here.

    Returns
    -------
    str or None
        What to tell people in one line; None where nothing was changed.
    """
    named = os.environ.get(VARIABLE)
    if not named:
        return None
    try:
        import mujoco  # noqa: F401
    except Exception as error:  # whatever the libraries of a renderer raise
        os.environ[VARIABLE] = "disable"
        return (
            f"{VARIABLE}={named} does not work here ({one_line(error):.100}); going on without "
            f"it: unset {VARIABLE}, or see tpsim doctor"
        )
    return None


def _draws(name: str) -> bool:
    """Whether a process of its own can draw with ``MUJOCO_GL=name``."""
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE],
            env={**os.environ, VARIABLE: name},
            capture_output=True,
            timeout=60,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return probe.returncode == 0
