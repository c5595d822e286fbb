"""What all frames retrieve at a time, as one Gaussian of the posture: TP-GMR in joint space."""

import numpy as np

from tpsim.controllers.product import Skill, Stack, StackedModel
from tpsim.gaussian import Gaussian, mixed_moments
from tpsim.learning.gmm import GMM
from tpsim.retrieval.gmr import Regression
from tpsim.retrieval.tp_gmr import Order, at_equal_input
from tpsim.robot.state import State


class TimedProduct:
    """Regression over time and product over frames, in the orders of :func:`tp_gmr`.

    Views take the place of frames: their Jacobians carry what was learned into joint space, in
    information form, around the present posture and the present objects.

    Parameters
    ----------
    skill : Skill
        Its model's frames have time before the view, Eq. (20).
    prior : Gaussian (n,), optional
        Joint posture [rad] for directions that no frame determines.
    order : str
        Of :func:`tp_gmr`.
    times : (S,)
        When it will be asked [s]; other times take longer.
    """

    def __init__(self, skill: Skill, prior: Gaussian | None, order: Order, times: np.ndarray):
        views, frames = list(skill.views.values()), skill.model.frames
        self._inputs = int(order == "product")
        self._stack = Stack(views, [frame.dim - 1 for frame in frames], self._inputs)
        self._blocks = [self._stack.blocks[view] for view in views]
        self._model = StackedModel(skill, self._stack) if self._inputs else None
        self._views = [Regression.of(GMM(skill.model.priors, frame)) for frame in frames]
        self._order, self._prior, self._times = order, prior, times
        self._state: State | None = None
        self._seen: tuple[np.ndarray, np.ndarray] = np.zeros(0), np.zeros((0, 0))
        self._found: dict[float, tuple[np.ndarray, Gaussian, np.ndarray]] = {}
        # What frames retrieve depends on no state: all at once, before the movement begins.
        self._known = None if self._inputs else self._local(times)

    def step(self, state: State, time: float) -> Gaussian:
        """Step (n,) from the present posture that the movement asks for at a time."""
        weights, asked, _ = self._asked(state, time)
        return mixed_moments(weights, asked)

    def drift(self, state: State, time: float) -> np.ndarray:
        """Joint velocity (n,) [rad/s] at which that posture moves with the objects.

        The components count as they do now: that of each moves by ``-P^-1 J^T W d``, where its
        product over frames has the precision P = J^T W J in joint space and views drift by d.
        """
        if state.objects.twists is None:
            return np.zeros(state.robot.n)
        weights, asked, WJ = self._asked(state, time)
        turned = self._stack.drift(state) @ WJ
        moved: np.ndarray = -weights @ (asked.covariance @ turned[..., None])[..., 0]
        return moved

    def _asked(self, state: State, time: float) -> tuple[np.ndarray, Gaussian, np.ndarray]:
        """Weights (K,) and steps (K, n) of the components at a time, and their W J (K, m, n)."""
        if self._state is not state:
            self._state, self._seen, self._found = state, self._see(state), {}
        found = self._found.get(time)
        if found is None:
            found = self._found[time] = self._ask(state, time)
        return found

    def _ask(self, state: State, time: float) -> tuple[np.ndarray, Gaussian, np.ndarray]:
        lead, (y, J) = self._inputs, self._seen
        if self._model is None:
            weights, precision, mean = self._at(time)
        else:
            precision, mean = self._model.precision, self._model.mean
        WJ = precision @ J
        product = J.T @ WJ
        target = ((mean - y)[:, None] @ WJ).mT
        if self._prior is not None:
            known = self._prior.precision
            product[:, lead:, lead:] += known
            target[:, lead:, 0] += known @ (self._prior.mean - state.q)
        if self._model is not None:
            conditional = _regression(self._model.log_priors, product, target)
            return *conditional.mixture(np.array(time)), WJ[..., lead:]
        covariance = np.linalg.inv(product)
        return weights, Gaussian.trusted((covariance @ target)[..., 0], covariance), WJ

    def _see(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Views (m,) and their Jacobians (m, n), after that of the time where there is one."""
        lead, size = self._inputs, self._stack.size
        y, J = np.zeros(size), np.zeros((size, lead + state.robot.n))
        self._stack.see(state, y, J[:, lead:])
        if lead:
            J[[block.start for block in self._blocks], 0] = 1.0
        return y, J

    def _at(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Weights (K,), precision (K, m, m), mean (K, m) of what all frames retrieve at a time."""
        assert self._known is not None
        step = int(np.searchsorted(self._times, time - 1e-9))
        known = step < len(self._times) and abs(self._times[step] - time) <= 1e-9
        parts = self._known if known else self._local(np.array([time]))
        weights, precision, mean = (part[step if known else 0] for part in parts)
        return weights, precision, mean

    def _local(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The same at many times: (S, K), (S, K, m, m), (S, K, m)."""
        weights, local = at_equal_input(self._views, times, self._order)
        m = self._stack.size
        precision, mean = np.zeros((*weights.shape, m, m)), np.zeros((*weights.shape, m))
        for rows, view in zip(self._blocks, local, strict=True):
            precision[..., rows, rows] = np.linalg.inv(view.covariance)
            mean[..., rows] = view.mean
        return weights, precision, mean


def _regression(
    log_priors: np.ndarray, precision: np.ndarray, information: np.ndarray
) -> Regression:
    """Regression of the other variables on the first, Eqs 14-16, of Gaussians in information form.

    ``precision`` (K, 1 + n, 1 + n) and ``information`` (K, 1 + n, 1).
    """
    covariance = np.linalg.inv(precision[:, 1:, 1:])
    cross = precision[:, :1, 1:]
    slope = -(covariance @ cross.mT)
    rest = covariance @ information[:, 1:]
    input_precision = precision[:, :1, :1] + cross @ slope
    input_mean = (information[:, :1] - cross @ rest) / input_precision
    return Regression.trusted(
        input_mean[..., 0],
        (rest + slope * input_mean)[..., 0],
        np.concatenate((np.sqrt(input_precision), slope), axis=1),
        covariance,
        log_priors + 0.5 * np.log(input_precision[:, 0, 0]),
    )
