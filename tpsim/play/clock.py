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

PATIENCE = 0.2
"""Time [s] by which the simulation may be late and still catch up."""

BREATH = 0.0005
"""Time [s] left to those who wait for the session, also where it is late."""

WINDOW = 5.0
"""Time [s] over which the factor is measured."""


class Pace:
    """The rule: how many time steps are due.

    Parameters
    ----------
    timestep : float
        [s]
    now : float
        On the wall clock [s].

    Attributes
    ----------
    late : float
        By how much the simulation is late [s].
    simulated, passed : float
        Simulated time, and real time times speed, up to now [s].
    factor : float
        Of the last seconds; 1 is real time.
    """

    def __init__(self, timestep: float, now: float):
        self._timestep, self._before = timestep, now
        self.late = self.simulated = self.passed = 0.0
        self.factor, self._mark = 1.0, (now, 0.0, 0.0)

    def due(self, now: float, speed: float) -> int:
        """Time steps to compute now, in one go."""
        asked = speed * (now - self._before)
        self._before = now
        self.passed += asked
        self.late += asked
        if self.late > PATIENCE:
            self.late = BATCH
        steps = int(min(self.late, BATCH) / self._timestep)
        self.late -= steps * self._timestep
        self.simulated += steps * self._timestep
        if now - self._mark[0] > WINDOW:
            done, asked = self.simulated - self._mark[1], self.passed - self._mark[2]
            self.factor = done / asked if asked > 0 else 1.0
            self._mark = (now, self.simulated, self.passed)
        return steps

    @property
    def rest(self) -> float:
        """Time [s] to leave to others now."""
        return BREATH if self.late > TICK else TICK


class RealTime(threading.Thread):
    """Lets time pass in a session until it is stopped.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    pace : Pace
    failure : Exception, optional
        What ended it, other than :meth:`stop`.
    """

    def __init__(self, session: Session):
        super().__init__(name="tpsim physics", daemon=True)
        self.failure: Exception | None = None
        self._session, self._ended = session, threading.Event()
        self.pace = Pace(session.world.timestep, time.monotonic())

    def stop(self) -> None:
        """End, and wait until it has."""
        self._ended.set()
        self.join()

    def run(self) -> None:
        """Let time pass."""
        session = self._session
        self.pace = pace = Pace(session.world.timestep, time.monotonic())
        try:
            with one_thread():
                while not self._ended.is_set():
                    if steps := pace.due(time.monotonic(), session.speed):
                        with session.lock:
                            session.advance(steps)
                    time.sleep(pace.rest)
        except Exception as error:
            self.failure = error
