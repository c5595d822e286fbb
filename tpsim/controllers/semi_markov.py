"""A movement of hidden states, without a clock: HSMM, then LQT over what comes next, as torque."""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim.border import Count, Duration, Positive, border
from tpsim.checks import Seed, generator, instance
from tpsim.control.constrained import constrained_lqt
from tpsim.control.constraints import Constraint
from tpsim.control.lqt import lqt
from tpsim.control.references import state_references
from tpsim.control.system import integrator
from tpsim.controllers.renewed import RenewedImpedance
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.hsmm import HSMM
from tpsim.learning.markov import draw
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.retrieval.progress import Belief, Pace, ProgressFilter
from tpsim.robot.state import State
from tpsim.robot.views.view import View
from tpsim.world.impedance import Impedance

Frames = Callable[[State], Sequence[Frame]]
"""Frames of a view's coordinates, as they are now."""

Limits = Callable[[State], Sequence[Constraint]]
"""Constraints on states [y, dy] and controls ddy, as they are now."""

REST = 20.0
"""Stiffness [1/s^2] with which joints that the view leaves open keep the posture of the start."""


class SemiMarkovTracking(RenewedImpedance):
    """Receding-horizon LQT (Section 6) along the states that an HSMM expects from what it sees.

    What is seen of position and velocity says in which state the movement is and how fast it goes
    (:class:`~tpsim.retrieval.progress.ProgressFilter`); the most likely states to come are the
    reference of position and velocity, with the precisions of the model. Nothing depends on time:
    held, the movement waits; led into another way that was taught, it goes on there; a loop goes
    round for ever.

    Parameters
    ----------
    view : View
        y (d,) that is controlled.
    model : HSMM
        Of states [y, dy] (2 d), in common coordinates or, with ``frames``, in those of frames.
    dt : float
        Time of the model's steps [s].
    effort : float
        Cost of acceleration, against the log-likelihood of the movement.
    horizon : int
        Steps that are looked ahead.
    slip : float
        Share of the movement's usual speed by which a hand may be slower or faster without being
        taken for held or pushed on, and of what it moves in half a stay by which it may stray: it
        yields to whoever touches it. Give more where constraints slow it down.
    frames : callable, optional
        ``frames(state)``: the frames of y as they are now, for a model that lives in frames.
    constraints : callable, optional
        ``constraints(state)``: what every plan keeps. Where none keeps all, those on [y, dy] are
        missed by as little as can be; ``missed`` says which, and by how much at most.
    pace : Pace, optional
    rng : int or numpy.random.Generator, optional
        Draws which of several ways is taken; the most likely one by default, of equal ones the
        first.
    """

    @border
    def __init__(
        self,
        view: View,
        model: HSMM,
        *,
        dt: Duration,
        effort: Positive,
        horizon: Count = 30,
        slip: Positive = 0.5,
        frames: Frames | None = None,
        constraints: Limits | None = None,
        pace: Pace | None = None,
        rng: Seed = None,
    ):
        super().__init__(dt)
        chain = instance("model.chain", model.chain, SemiMarkovChain, "of fit_hsmm")
        if frames is None and not isinstance(model.emissions, GMM):
            raise ArgumentError("the model lives in frames; give frames(state), or adapt it first")
        self.view, self.model, self.frames, self.horizon = view, model, frames, horizon
        self.effort, self._filter = effort, ProgressFilter(chain, pace)
        self._ahead = ProgressFilter(chain if rng is None else _decided(chain, rng), pace)
        self._dt, self._slip, self.constraints = dt, slip, constraints
        self.missed: dict[str, float] = {}
        self._belief: Belief | None = None
        self._rest: np.ndarray | None = None

    @property
    def belief(self) -> Belief | None:
        """What is known of the progress; None before the first command."""
        return self._belief

    def renew(self, state: State, time: float) -> Impedance:
        """See, infer, look ahead, and act for one step of the model."""
        if self._rest is None:
            self._rest = state.q
        seen = self.view(state)
        y, J = seen.value, seen.jacobian
        speed = J @ state.dq + seen.drift
        model = self.model
        if self.frames is not None:
            model = model.adapt([frame.with_derivatives(1) for frame in self.frames(state)])
        gaussians, d = model.gaussians, len(y)
        self._see(gaussians, np.concatenate([y, speed]), d)
        assert self._belief is not None
        states = self._ahead.states_ahead(self._belief, self.horizon)
        references = state_references(gaussians, [states])
        problem = *references, integrator(d, self._dt, exact=True), self.effort
        law = lqt(*problem)
        spring, brake = law.gain[0, :, :d], law.gain[0, :, d:]
        pull = law.feedforward[0] - spring @ y
        if self.constraints is not None and (kept := self.constraints(state)):
            now = np.concatenate([y, speed])
            plan = constrained_lqt(*problem, now, kept, infeasible="relax")
            # The law's stiffness and damping, about what may be done.
            pull = plan.controls[0] + brake @ speed
            for name, most in plan.missed.items():
                self.missed[name] = max(most, self.missed.get(name, 0.0))
        return self._impedance(state, J, spring, brake, pull)

    def _see(self, gaussians: Gaussian, observed: np.ndarray, d: int) -> None:
        """Of a hand at v ticks a step a state expects v times its velocity."""
        paces = np.arange(len(self._filter.pace.likely))
        means = np.tile(gaussians.mean, (len(paces), 1, 1))
        means[..., d:] *= paces[:, None, None]
        usual = self._slip * np.sqrt(np.mean(np.sum(gaussians.mean[:, d:] ** 2, axis=1)))
        half_stay = 0.5 * self._dt * self._filter.chain.durations.mean.mean()
        stray = np.diag(np.repeat([half_stay * usual, usual], d) ** 2)
        covariances = np.tile(gaussians.covariance + stray, (len(paces), 1, 1, 1))
        density = Gaussian.trusted(means, covariances).log_density(observed)[..., None]
        if self._belief is None:
            self._belief = self._filter.start(density)
        else:
            self._belief = self._filter.update(self._belief, density)

    def _impedance(
        self,
        state: State,
        J: np.ndarray,
        spring: np.ndarray,
        brake: np.ndarray,
        pull: np.ndarray,
    ) -> Impedance:
        """Joint impedance of ``ddy = pull - spring (y' - y) - brake dy'``, the rest at rest.

        What pulls is a reference that moves off from where the arm is: a spring that is bent
        anew with every step would take its energy out of the tank for nothing.
        """
        M = state.mass
        felt = np.linalg.pinv(J @ np.linalg.solve(M, J.T), rcond=1e-4, hermitian=True)
        lever = J.T @ felt
        null = M - lever @ J
        stiffness = lever @ spring @ J + REST * null
        damping = lever @ brake @ J + 2 * REST**0.5 * null
        way = np.linalg.solve(stiffness, REST * null @ (self._rest - state.q))
        velocity = np.linalg.solve(damping, lever @ pull)
        return Impedance(stiffness, damping, state.q + way, velocity)


def _decided(chain: SemiMarkovChain, rng: Seed) -> SemiMarkovChain:
    """The chain with one of all ways drawn at every fork."""
    random, decided = generator("rng", rng), np.zeros_like(chain.transitions)
    for state, follows in enumerate(chain.transitions):
        if follows.any():
            decided[state, draw(follows, random)] = 1.0
    return SemiMarkovChain(chain.initial, decided, chain.durations, chain.least_variance)
