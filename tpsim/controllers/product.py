"""The product of all frames of all learned behaviours (Eq. 6), laid over the views they observe."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from tpsim.border import checked
from tpsim.errors import ArgumentError, UnseenError
from tpsim.gaussian import Gaussian, faded
from tpsim.learning.gmm import log_priors
from tpsim.learning.tp_gmm import TPGMM
from tpsim.robot.objects import Objects
from tpsim.robot.state import State
from tpsim.robot.views.view import View


@dataclass(frozen=True)
class Skill:
    """A learned behaviour: a TP-GMM and the views that its frames observe.

    Parameters
    ----------
    views : mapping of str to View
        One for each frame of the model, in this order.
    model : TPGMM
    """

    views: Mapping[str, View]
    model: TPGMM

    def __post_init__(self) -> None:
        checked(self)
        if len(self.views) != len(self.model.frames):
            raise ArgumentError(
                f"{len(self.views)} views {tuple(self.views)} were given for a model of "
                f"{len(self.model.frames)} frames; give one for each"
            )


class Stack:
    """Several views, one upon the other, each of them once.

    Parameters
    ----------
    views : sequence of View
    sizes : sequence of int
        Rows that each takes.
    inputs : int
        Rows before those of each view, such as one for time.
    """

    def __init__(self, views: Sequence[View], sizes: Sequence[int], inputs: int = 0):
        found: dict[View, int] = {}
        for view, size in zip(views, sizes, strict=True):
            if found.setdefault(view, size) != size:
                raise ArgumentError(f"two models see {view} in {found[view]} and {size} dimensions")
        ends = np.cumsum([size + inputs for size in found.values()])
        self.size = int(ends[-1])
        self.views = tuple(found)
        self.rows = [slice(e - s, e) for s, e in zip(found.values(), ends.tolist(), strict=True)]
        self.blocks = {
            view: slice(rows.start - inputs, rows.stop)
            for view, rows in zip(found, self.rows, strict=True)
        }

    def see(self, state: State, y: np.ndarray, J: np.ndarray) -> None:
        """Write values into y (size,) and Jacobians into J (size, n).

        Views of objects that were not seen yet stay zero: through them nothing acts.
        """
        for view, rows in zip(self.views, self.rows, strict=True):
            try:
                seen = view(state)
            except UnseenError:
                continue
            y[rows], J[rows] = seen.value, seen.jacobian

    def follow(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Drift (size,) of the views, and how their values follow the joints (size, n).

        They drift while the robot rests, since objects move.
        """
        drift, rate = np.zeros(self.size), np.zeros((self.size, state.robot.n))
        for view, rows in zip(self.views, self.rows, strict=True):
            with suppress(UnseenError):
                seen = view(state)
                drift[rows] = seen.drift
                rate[rows] = seen.jacobian if seen.rate is None else seen.rate
        return drift, rate

    def drift(self, state: State) -> np.ndarray:
        """Rates (size,) at which the views change while the robot rests, since objects move."""
        return self.follow(state)[0]

    def unsure(self, state: State) -> np.ndarray:
        """Covariance (size, size) of the views, from that of the objects that they look from or at.

        A view drifts at a unit velocity of an object as it changes with its pose.
        """
        objects, count = state.objects, len(state.objects.positions)
        found = np.zeros((self.size, self.size))
        assert objects.covariances is not None
        for name in objects:
            lever = np.zeros((self.size, 6))
            for k in range(6):
                twists = np.zeros((count, 6))
                twists[objects.row(name), k] = 1.0
                moving = State(state.robot, state.x, objects.moving(twists), state.time)
                lever[:, k] = self.drift(moving)
            found += lever @ objects.covariances[objects.row(name)] @ lever.T
        return found


@dataclass(frozen=True, eq=False)
class Information:
    """The product of all frames at one state, in information form.

    Parameters
    ----------
    value : (m,)
        Stacked views y.
    jacobian : (m, n)
    precision : (m, m)
        W, mixed over components by their responsibilities, Eq. (49).
    target : (m,)
        W mu.
    """

    value: np.ndarray
    jacobian: np.ndarray
    precision: np.ndarray
    target: np.ndarray


class Product:
    """All frames of all skills as one precision over their stacked views.

    Precisions of several frames, and of several skills that were learned apart, add up. Where
    objects are known up to a covariance only, that of the views which it makes is added to the
    learned one before: precision fades.

    Parameters
    ----------
    skills : sequence of Skill

    Attributes
    ----------
    free_precision : (m, m)
        Of free movement, added up over all frames: the product, if everything was free.
    """

    def __init__(self, skills: Sequence[Skill]):
        if not skills:
            raise ArgumentError("no skill was given; give at least one")
        pairs = [
            (view, frame.dim)
            for skill in skills
            for view, frame in zip(skill.views.values(), skill.model.frames, strict=True)
        ]
        self.stack = Stack([view for view, _ in pairs], [size for _, size in pairs])
        self._experts = [StackedModel(skill, self.stack) for skill in skills]
        roots, self._free_starts = [np.zeros((0, self.stack.size))], []
        for skill in skills:
            for view, known in zip(skill.views.values(), skill.model.relevance, strict=False):
                root = np.zeros((len(known.free), self.stack.size))
                root[:, self.stack.blocks[view]] = np.linalg.cholesky(np.linalg.inv(known.free)).T
                self._free_starts.append(sum(map(len, roots)))
                roots.append(root)
        self._free = np.concatenate(roots)
        self.free_precision = self._free.T.dot(self._free)
        self._looked: tuple[Objects, np.ndarray] | None = None
        # With one component each, nothing depends on the state.
        self._fixed = None
        if all(expert.components == 1 for expert in self._experts):
            self._fixed = self._mix(np.zeros(self.stack.size))

    def _mix(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        W, target = self._experts[0].information(y)
        for expert in self._experts[1:]:
            more = expert.information(y)
            W, target = W + more[0], target + more[1]
        return W, target

    @property
    def seen(self) -> np.ndarray:
        """Precision (m, m) of all Gaussians as they were learned, summed over components."""
        return np.sum([expert.seen.sum(0) for expert in self._experts], axis=0)

    def free(self, directions: np.ndarray) -> np.ndarray:
        """Precision (k,) of free movement along changes (m, k) of the stacked views.

        That of the frame which sees most of it; zero where no frame knows of free movement.
        """
        if not self._free_starts:
            return np.zeros(directions.shape[1])
        seen = self._free.dot(directions) ** 2
        most: np.ndarray = np.maximum.reduce(np.add.reduceat(seen, self._free_starts))
        return most

    def at(self, state: State) -> Information:
        """The product at a state."""
        size = self.stack.size
        y, J = np.zeros(size), np.zeros((size, state.robot.n))
        self.stack.see(state, y, J)
        W, Wmu = self._fixed or self._mix(y)
        if state.objects.covariances is not None:
            if self._looked is None or self._looked[0] is not state.objects:
                self._looked = state.objects, self.stack.unsure(state)
            left = faded(W, self._looked[1])
            W, Wmu = left @ W, left @ Wmu
            W = 0.5 * (W + W.T)
        return Information(y, J, W, Wmu)


class StackedModel:
    """One skill's Gaussians, laid out over a stack of views.

    Parameters
    ----------
    skill : Skill
    stack : Stack

    Attributes
    ----------
    components : int
    precision : (K, m, m)
        Of what matters in every frame.
    seen : (K, m, m)
        Of the Gaussians as they were learned, which decide about responsibilities.
    mean : (K, m)
    log_priors : (K,)
    """

    def __init__(self, skill: Skill, stack: Stack):
        model = skill.model
        self.components = K = model.components
        self.precision, self.mean = np.zeros((K, stack.size, stack.size)), np.zeros((K, stack.size))
        self.seen = np.zeros_like(self.precision)
        self.log_priors = log_priors(model.priors)
        self._bias = self.log_priors.copy()
        for view, gaussian, precision in zip(
            skill.views.values(), model.frames, model.precisions, strict=True
        ):
            rows = stack.blocks[view]
            self.precision[:, rows, rows] = precision
            self.seen[:, rows, rows] = gaussian.precision
            self.mean[:, rows] = gaussian.mean
            self._bias += 0.5 * np.linalg.slogdet(gaussian.precision)[1]
        self._target = np.einsum("kab,kb->ka", self.precision, self.mean)

    def information(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Precision W (m, m) and W mu (m,) at an observation y (m,): Eq. (49) mixes them."""
        if self.components == 1:
            return self.precision[0], self._target[0]
        e = y - self.mean
        h = self._bias - 0.5 * np.einsum("ka,kab,kb->k", e, self.seen, e)
        h = np.exp(h - h.max())
        h /= h.sum()
        return np.tensordot(h, self.precision, 1), h @ self._target


def posture_skill(prior: Gaussian, views: Mapping[str, View]) -> Skill:
    """A Gaussian (n,) on the posture as a skill, seen by one view."""
    frame = Gaussian(np.atleast_2d(prior.mean), prior.covariance[None])
    return Skill(views, TPGMM(np.ones(1), (frame,)))
