"""Real time: a thread that lets time pass in a session as it passes outside.

The rule. Every few milliseconds as many time steps are due as the wall clock, times the speed,
is ahead of the simulated one; at most ``BATCH`` seconds of them are computed in one go, so that
commands never wait longer. What is late up to ``PATIENCE`` seconds is caught up; beyond, the
difference is forgiven: the movement is slower than real time then, never in jumps, and every time
step is the same as ever. The share that passed in time is ``factor``.
"""

import threading
import time

from tpsim.play.session import Session
from tpsim.world.threads import one_thread

TICK = 0.004
"""Time [s] between two looks at the clock."""

BATCH = 0.02
"""Simulated time [s] that is computed in one go, at most."""

PATIENCE = 0.1
"""Time [s] by which the simulation may be late and still catch up."""

BREATH = 0.0005
"""Time [s] left to those who wait for the session, also where it is late."""

WINDOW = 5.0
"""Time [s] over which the factor is measured."""


class RealTime(threading.Thread):
    """Lets time pass in a session until it is stopped.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    factor : float
        Simulated time over real time times speed, over the last seconds; 1 is real time.
    simulated, passed : float
        Simulated time, and real time times speed, since the start [s].
    failure : Exception, optional
        What ended it, other than :meth:`stop`.
    """

    def __init__(self, session: Session):
        super().__init__(name="tpsim physics", daemon=True)
        self.factor, self.simulated, self.passed = 1.0, 0.0, 0.0
        self.failure: Exception | None = None
        self._session, self._ended = session, threading.Event()

    def stop(self) -> None:
        """End, and wait until it has."""
        self._ended.set()
        self.join()

    def run(self) -> None:
        """Let time pass."""
        try:
            with one_thread():
                self._run()
        except Exception as error:
            self.failure = error

    def _run(self) -> None:
        session, h = self._session, self._session.world.timestep
        late, before = 0.0, time.monotonic()
        mark = (before, 0.0, 0.0)
        while not self._ended.is_set():
            now = time.monotonic()
            due, before = session.speed * (now - before), now
            late, self.passed = late + due, self.passed + due
            if late > PATIENCE:
                late = BATCH
            steps = int(min(late, BATCH) / h)
            if steps:
                with session.lock:
                    session.advance(steps)
                late -= steps * h
                self.simulated += steps * h
            if now - mark[0] > WINDOW:
                done, asked = self.simulated - mark[1], self.passed - mark[2]
                self.factor = done / asked if asked > 0 else 1.0
                mark = (now, self.simulated, self.passed)
            time.sleep(BREATH if late > BATCH else TICK)
