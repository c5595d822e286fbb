"""How far a movement has come, from what the hand is seen to do."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from tpsim.gaussian import Gaussian
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.retrieval.passage import Passage
from tpsim.retrieval.progress import Belief, Pace, ProgressFilter
from tpsim.robot.state import State
from tpsim.robot.views.view import Seen

PACE = Pace(np.array([0.15, 0.7, 0.15]), 0.7)
"""A person who holds or hurries a hand does so for some steps."""

STRAY = np.array([0.008] * 3 + [0.05] * 3)
"""How far [m], [rad] a hand may be from its movement besides what was taught: it yields."""

SLIP = np.array([0.05] * 3 + [0.3] * 3)
"""Standard deviation of its velocity [m/s], [rad/s]."""

LEAD, TEMPO = 0.12, ((-1.0, 0.0, 0.5, 1.0), (2.0, 1.0, 1.0, 0.0))
"""How far ahead of where hands are the movement is asked for at most [s], and how fast it goes on
at these shares of it: at its own tempo as long as hands keep up, faster if somebody pushes them on.
Hands that are held are asked for no more, yet let go they are drawn on."""

DRAWN = 0.06
"""Time [s] ahead of which a hand is to be drawn, so that noise does not stop it."""

PATIENCE = 0.4
"""Time [s] within which springs grow weak where a movement stands still, and strong again."""

ENDING = 0.1
"""Time [s] before its end from which on a movement may stand still of itself."""


class Progress(Protocol):
    """Says how far a movement has come; without one, the clock does."""

    def at(self, state: State, time: float) -> tuple[float, float]:
        """Time within the movement [s], and how much of it passes per second.

        Parameters
        ----------
        state : State
        time : float
            By the clock [s].
        """
        ...


class ByState:
    """The movement's time is inferred: :class:`~tpsim.retrieval.progress.ProgressFilter`.

    Parameters
    ----------
    chain : SemiMarkovChain
        Of the movement's states, durations in steps of ``dt``.
    dt : float
        Time step of the movement [s], and between two observations.
    pace : Pace
    stray, slip : (d,)
        How far hands may be from the movement besides what was taught, and the standard deviation
        of their velocity.
    """

    def __init__(
        self,
        chain: SemiMarkovChain,
        dt: float,
        pace: Pace = PACE,
        stray: np.ndarray = STRAY,
        slip: np.ndarray = SLIP,
    ):
        self._filter, self._dt = ProgressFilter(chain, pace), dt
        self._stray, self._slip = stray, slip
        self._passage: Passage | None = None
        self._see: Callable[[State], Seen] | None = None
        self._belief: Belief | None = None
        self._since, self._place, self._rate = 0.0, 0.0, 0.0

    def follow(self, see: Callable[[State], Seen], places: Gaussian) -> None:
        """See the hand along another movement from now on, as far as it has come.

        Parameters
        ----------
        see : callable
            How the hand is seen, such as a view (d,).
        places : Gaussian (S, d)
            What the movement asks of it, step by step.
        """
        # One for all: observations follow each other so fast that they are far from independent,
        # and a hand at rest would be drawn to wherever the movement is most precise.
        spread = places.covariance.mean(0) + np.diag(self._stray**2)
        alike = Gaussian.trusted(places.mean, np.broadcast_to(spread, places.covariance.shape))
        self._see = see
        self._passage = Passage(self._filter.chain, alike, self._dt, self._slip)

    def at(self, state: State, time: float) -> tuple[float, float]:
        """What the last observation said, led on to the next one without a jump."""
        if self._belief is None or time >= self._since + self._dt - 1e-9:
            self._observe(state, time)
        now = self._place + self._rate * (time - self._since)
        return now * self._dt, self._rate * self._dt

    def _observe(self, state: State, time: float) -> None:
        assert self._passage is not None and self._see is not None  # a plan comes before a law
        hand, paces = self._see(state), len(self._filter.pace.likely)
        velocity = hand.jacobian @ state.dq + hand.drift
        seen = self._passage.log_densities(hand.value, velocity, paces)
        if self._belief is None:
            self._belief = self._filter.start(seen)
        else:
            self._place += self._rate * (time - self._since)
            self._belief = self._filter.update(self._belief, seen)
        self._since = time
        soon = self._passage.place(self._filter.foreseen(self._belief))
        self._rate = (soon - self._place) / self._dt


class Ahead:
    """What of a movement is asked for, a little ahead of where hands are (:data:`LEAD`).

    Parameters
    ----------
    lead : float
        How far at most [s].
    """

    def __init__(self, lead: float = LEAD):
        self._lead, self._asked, self._since, self._rate = lead, 0.0, 0.0, 0.0

    def of(self, place: float, time: float, drawn: float = np.inf) -> tuple[float, float]:
        """Time within the movement [s] to ask for, and how much of it passes per second.

        Parameters
        ----------
        place : float
            Where in the movement hands are [s].
        time : float
            By the clock [s].
        drawn : float
            How hard hands are drawn on, of what those feel that are held so far behind: hands that
            do what is asked of them keep up, wherever they seem to be.
        """
        self._asked += self._rate * (time - self._since)
        self._since = time
        share = min((self._asked - place) / self._lead, drawn)
        self._rate = float(np.interp(share, *TEMPO))
        return self._asked, self._rate


class Patience:
    """How strong springs may be: as usual, or weak where the movement stands still.

    Who holds a hand would else let go a spring that is wound up.

    Parameters
    ----------
    held, usual : float
        Share of the motors' torque that springs may ask for where it stands still, and at the
        movement's own tempo.
    end : float
        Time within the movement [s] at which it stands still of itself; springs stay strong.

    Attributes
    ----------
    going : float
        0 where it stands still, 1 where it goes on or has ended.
    """

    def __init__(self, held: float, usual: float = 1.0, end: float = np.inf):
        self._held, self._usual, self._end = held, usual, end - ENDING
        self._asked, self.going = 0.0, 1.0

    def strength(self, time: float, place: float, rate: float) -> float:
        """Share of the motors' torque that springs may ask for.

        Parameters
        ----------
        time : float
            By the clock [s].
        place, rate : float
            Time within the movement [s], and how much of it passes per second.
        """
        kept = np.exp((self._asked - time) / PATIENCE)
        going = 1.0 if place > self._end else min(rate, 1.0)
        self._asked, self.going = time, kept * self.going + (1 - kept) * going
        return self._held + (self._usual - self._held) * self.going


class AheadOfState(ByState):
    """The movement's time as it is inferred, and asked for a little ahead (:class:`Ahead`).

    A critically damped spring that follows a movement draws as if from two over its natural
    frequency ahead; stiff ones are asked for the rest of :data:`DRAWN`.

    A hand that nobody holds moves no faster than it is asked to: while little is asked of it, its
    velocity is that of a hand that is held. What tells them apart is how hard it is drawn on: not
    at all where it does what is asked of it (:meth:`draw`).

    Parameters
    ----------
    chain : SemiMarkovChain
    dt : float
        As for :class:`ByState` [s].
    stiffest : float
        Largest natural frequency of the springs [1/s].
    """

    def __init__(self, chain: SemiMarkovChain, dt: float, stiffest: float):
        super().__init__(chain, dt)
        self._lead, self._drawn = DRAWN - 2 / stiffest, np.inf
        self._ahead = Ahead(self._lead) if self._lead > 1e-9 else None

    def draw(
        self, lacks: np.ndarray, spring: np.ndarray, brake: np.ndarray, inertia: np.ndarray
    ) -> None:
        """Say how hard the hand is drawn, wherever to, beside one that is held a lead behind.

        As accelerations are weighed by Gauss's principle: with the inertia that the hand feels.

        Parameters
        ----------
        lacks : (3, d)
            Velocity of the movement at what is asked for, and what the hand lacks of place and
            velocity there.
        spring, brake : (d, d)
            Stiffness [1/s^2] and damping [1/s] that follow the movement.
        inertia : (d, d)
            That the hand feels.
        """
        way, late, slow = lacks
        pull, usual = spring @ late + brake @ slow, self._lead * spring @ way + brake @ way
        felt, held = (np.sqrt(one @ inertia @ one) for one in (pull, usual))
        # Where the movement rests nobody who holds it is drawn.
        self._drawn = float(felt / held) if held > 1e-6 else np.inf

    def at(self, state: State, time: float) -> tuple[float, float]:
        """Time within the movement [s] to ask for, and how much of it passes per second."""
        place, rate = super().at(state, time)
        return (place, rate) if self._ahead is None else self._ahead.of(place, time, self._drawn)
