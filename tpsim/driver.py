"""The process that drives others: they end when it is gone, also where it was killed.

Little is imported here, so that a process can look for its driver before anything slow.
"""

import os
import signal
import sys
import threading
import time
from contextlib import suppress

_LOOK = 0.2
"""Time [s] between two looks whether the driver is there."""


def end_others() -> None:
    """Kill the worker processes of this one, which is about to leave without a farewell."""
    if "multiprocessing" in sys.modules:
        for child in sys.modules["multiprocessing"].active_children():
            with suppress(ProcessLookupError):
                os.kill(child.pid, signal.SIGKILL)


def end_with(driver: int) -> None:
    """End this process soon after its parent, whose number is ``driver``."""

    def look() -> None:
        while os.getppid() == driver:
            time.sleep(_LOOK)
        os._exit(1)

    threading.Thread(target=look, daemon=True).start()
