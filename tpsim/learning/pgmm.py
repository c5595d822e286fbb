"""Parametric Gaussian mixture model (Section 8.2, App. D): centres that follow task parameters."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from tpsim.archive import Stored
from tpsim.checks import (
    Seed,
    bound,
    entries,
    finite_array,
    frozen_array,
    matrix,
    number,
    several,
    whole,
)
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian, symmetric
from tpsim.learning.em import EMPTY, Mixture, project, regularisation
from tpsim.learning.fit import Start
from tpsim.learning.gmm import GMM, checked_priors, fit_gmm, log_priors, log_sum, posterior
from tpsim.learning.regularisation import Regularisation
from tpsim.learning.start import RESOLUTION
from tpsim.learning.statistics import Samples
from tpsim.learning.subspace import Full


@dataclass(frozen=True, eq=False)
class PGMM(Stored):
    """Parametric Gaussian mixture model: mu_i = Z_i [Q; 1], Eq. (48).

    Parameters
    ----------
    priors : (K,)
        Mixing coefficients, summing to one.
    maps : (K, D, q + 1)
        Z_i: centres as affine maps of the q task parameters; the last column is the offset.
    covariance : (K, D, D)
        Covariances, the same for all task parameters.
    history : (n,)
        Mean log-likelihood of the data after every iteration of the fit.

    Raises
    ------
    ArgumentError
        Priors that are no distribution, or shapes that do not fit together.
    """

    priors: np.ndarray
    maps: np.ndarray
    covariance: np.ndarray
    history: np.ndarray = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        priors, maps = checked_priors(self.priors), frozen_array("maps", self.maps)
        covariance = frozen_array("covariance", self.covariance)
        K, D = len(priors), maps.shape[1] if maps.ndim == 3 else 0
        if maps.ndim != 3 or len(maps) != K or covariance.shape != (K, D, D):
            raise ArgumentError(
                f"maps have shape {maps.shape} and covariance {covariance.shape}; with {K} "
                f"priors they must be ({K}, D, q + 1) and ({K}, D, D)"
            )
        history = frozen_array("history", self.history)
        for name, value in (
            ("priors", priors),
            ("maps", maps),
            ("covariance", Gaussian(np.zeros((K, D)), covariance).covariance),
            ("history", history),
        ):
            object.__setattr__(self, name, value)

    @property
    def components(self) -> int:
        """Number of components K."""
        return len(self.priors)

    @property
    def free_parameters(self) -> int:
        """Number of free parameters: maps, covariances and priors."""
        D = self.maps.shape[1]
        return self.maps.size + self.components * (D * (D + 1) // 2 + 1) - 1

    def adapt(self, parameters: ArrayLike) -> GMM:
        """Mixture (..., K, D) for new task parameters (..., q), Eq. (48)."""
        Q = finite_array("parameters", parameters)
        if Q.shape[-1:] != (self.maps.shape[-1] - 1,):
            raise ArgumentError(
                f"parameters have shape {Q.shape}; the model asks for "
                f"(..., {self.maps.shape[-1] - 1})"
            )
        mean = _centres(self.maps, _with_one(Q))
        return GMM(self.priors, Gaussian(mean, self.covariance))

    def log_likelihood(self, data: ArrayLike, parameters: ArrayLike) -> np.ndarray:
        """Log-likelihood (N,) of samples (N, D) under task parameters (q,) or (N, q)."""
        return log_sum(self._log_joint(data, parameters))

    def responsibilities(self, data: ArrayLike, parameters: ArrayLike) -> np.ndarray:
        """Posterior of every component for every sample, Eq. (76), (N, K)."""
        return posterior(self._log_joint(data, parameters))

    def _log_joint(self, data: ArrayLike, parameters: ArrayLike) -> np.ndarray:
        rows = matrix("data", data, self.maps.shape[1])
        means = self.adapt(parameters).gaussians.mean
        if means.shape[:-2] not in ((), (len(rows),)):
            raise ArgumentError(
                f"parameters have leading axes {means.shape[:-2]} and data {len(rows)} samples; "
                "give one (q,), or one for every sample"
            )
        residual = rows[:, None] - means
        noise = Gaussian(np.zeros(self.maps.shape[:2]), self.covariance)
        return log_priors(self.priors) + noise.log_density(residual)


def task_vector(frames: Sequence[Frame]) -> np.ndarray:
    """Task parameters Q (..., q) of frames: offsets and columns of all matrices, Section 8.2."""
    frames = several("frames", frames, Frame)
    if not frames:
        raise ArgumentError("no frames were given; task parameters need at least one")
    parts = [
        part
        for frame in frames
        for part in (frame.b, frame.A.mT.reshape(*frame.shape, frame.dim * frame.local_dim))
    ]
    leading = np.broadcast_shapes(*(frame.shape for frame in frames))
    parts = [np.broadcast_to(part, (*leading, part.shape[-1])) for part in parts]
    return np.concatenate(parts, axis=-1)


def fit_pgmm(
    sequences: Sequence[Demonstration] | Sequence[ArrayLike],
    parameters: Sequence[ArrayLike] | None,
    components: int,
    *,
    start: Start | GMM = None,
    ridge: float | None = None,
    task_ridge: float | None = None,
    tolerance: float = 1e-5,
    max_iterations: int = 100,
    rng: Seed = None,
) -> PGMM:
    """Fit a parametric GMM by expectation-maximisation, Eqs (76-80).

    Parameters
    ----------
    sequences : sequence of M Demonstration or (T_m, D) arrays
        Movements of any lengths, in common coordinates.
    parameters : sequence of M arrays (q,) or (T_m, q), optional
        Task parameters of every movement; None takes :func:`task_vector` of its frames.
    components : int
        Number of components K.
    start : str or GMM, optional
        A mixture to begin with, whose centres do not move with the task yet; or how to fit one,
        as in :func:`tpsim.learning.gmm.fit_gmm`.
    ridge : float, optional
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.
    task_ridge : float, optional
        Added to the diagonal of the matrix that Eq. (78) inverts. By default none: with fewer
        situations than task parameters, directions that the demonstrations do not show get the
        map of least norm in standardised parameters.
    tolerance, max_iterations, rng
        As in :func:`tpsim.learning.tp_gmm.fit_tp_gmm`.

    Returns
    -------
    PGMM
        Its ``history[-1]`` is the likelihood of the model returned.

    Raises
    ------
    ArgumentError
        Data, task parameters or options without a finite answer; the message says which.

    Notes
    -----
    Departures from the tutorial's code: it adds 1e-4 I to the matrix inverted in Eq. (78), offset
    included, and to the numerator of Eq. (79), which is then divided by the component's mass;
    ours adds nothing to the former and regularises the covariance itself.
    """
    if task_ridge is not None:
        task_ridge = number("task_ridge", task_ridge, least=0)
    bound("tolerance", tolerance)
    max_iterations = whole("max_iterations", max_iterations)
    single = isinstance(sequences, Demonstration)
    given: list[object] = [sequences] if single else entries("sequences", sequences)
    arrays, Q = _checked(given, parameters)
    if not isinstance(start, GMM):
        start = fit_gmm(arrays, components, start=start, ridge=ridge, rng=rng)
    data = np.concatenate(arrays)
    if start.gaussians.mean.shape != (components, data.shape[1]):
        raise ArgumentError(
            f"start has means of shape {start.gaussians.mean.shape}; components and sequences "
            f"ask for {(components, data.shape[1])}"
        )
    origin = data.mean(0)  # far from zero, the moments below would lose their digits
    data = data - origin
    samples = Samples([data])
    start = GMM(start.priors, Gaussian(start.gaussians.mean - origin, start.gaussians.covariance))
    begun = Mixture.of(np.maximum(start.priors, EMPTY), [start.gaussians], samples)
    _, parts = samples.expectation(begun.priors, begun.components)
    limit = regularisation(samples, ridge, parts)[0]
    start = GMM(start.priors, project(begun, Full(), [limit]).frames(samples)[0])
    centre, scale = _standard(Q) if task_ridge is None else (np.zeros(Q.shape[1]), 1.0)
    Q = (Q - centre) / scale
    model = _at_rest(start, Q.shape[1])
    history: list[float] = []
    while True:
        joint = model._log_joint(data, Q)
        history.append(log_sum(joint).mean())
        converged = len(history) > 1 and history[-1] - history[-2] < tolerance
        if converged or len(history) > max_iterations:
            break
        model = _maximised(model, data, Q, posterior(joint), limit, task_ridge or 0.0)
    slopes = model.maps[..., :-1] / scale
    offsets = model.maps[..., -1] - slopes @ centre + origin
    maps = np.concatenate([slopes, offsets[..., None]], axis=-1)
    return PGMM(model.priors, maps, model.covariance, np.array(history))


def _maximised(
    model: PGMM,
    data: np.ndarray,
    Q: np.ndarray,
    h: np.ndarray,
    limit: Regularisation,
    task_ridge: float,
) -> PGMM:
    """M-step, Eqs (77-80); a component without samples stays where it was."""
    weight, Q = h.sum(0), _with_one(Q)
    weighted = h.T[:, :, None] * Q
    moment = weighted.mT @ Q + task_ridge * np.eye(Q.shape[1])
    maps = data.T @ weighted @ np.linalg.pinv(moment, rcond=1e-10, hermitian=True)
    alive = weight > EMPTY
    maps = np.where(alive[:, None, None], maps, model.maps)
    residual = np.swapaxes(data[:, None] - _centres(maps, Q), 0, 1)
    scatter = (h.T[:, :, None] * residual).mT @ residual
    scatter /= np.maximum(weight, EMPTY)[:, None, None]
    covariance, _ = Full().fit(symmetric(scatter)[None], None, limit)
    covariance = np.where(alive[:, None, None], covariance[0], model.covariance)
    return PGMM(weight / weight.sum(), maps, covariance)


def _at_rest(start: GMM, parameters: int) -> PGMM:
    """Centres that do not move with the task yet."""
    mean = start.gaussians.mean[..., None]
    maps = np.concatenate([np.zeros((*mean.shape[:2], parameters)), mean], axis=-1)
    return PGMM(start.priors, maps, start.gaussians.covariance)


def _checked(
    sequences: list[object], given_parameters: object
) -> tuple[list[np.ndarray], np.ndarray]:
    """Sequences as arrays, and task parameters (N, q) of every sample."""
    if given_parameters is None:
        framed = [s for s in sequences if isinstance(s, Demonstration) and s.frames]
        if len(framed) < len(sequences):
            raise ArgumentError("without parameters, give demonstrations with frames")
        given_parameters = [task_vector(demonstration.frames) for demonstration in framed]
    raw = [s.data if isinstance(s, Demonstration) else s for s in sequences]
    data = [finite_array(f"sequences[{m}]", one) for m, one in enumerate(raw)]
    shapes = [one.shape for one in data]
    if not shapes or any(len(s) != 2 or 0 in s or s[1] != shapes[0][1] for s in shapes):
        raise ArgumentError(f"sequences have shapes {shapes}; give (T_m, D) of one D, none empty")
    parameters = [
        finite_array(f"parameters[{m}]", one)
        for m, one in enumerate(entries("parameters", given_parameters, tables=False))
    ]
    given = [q.shape for q in parameters]
    allowed = [(q[-1:], (shape[0], *q[-1:])) for q, shape in zip(given, shapes, strict=False)]
    one_each = len(given) == len(data) and len({q[-1:] for q in given}) == 1 and given[0]
    if not one_each or any(q not in both for q, both in zip(given, allowed, strict=True)):
        raise ArgumentError(
            f"parameters have shapes {given} for sequences of shapes {shapes}; give one (q,) or "
            "(T_m, q) for every sequence, of one q"
        )
    width = given[0][-1]
    wide = [np.broadcast_to(q, (len(x), width)) for q, x in zip(parameters, data, strict=True)]
    return data, np.concatenate(wide)


def _standard(Q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of the columns; without limit where a column is constant."""
    centre, scale = Q.mean(0), Q.std(0)
    return centre, np.where(scale > RESOLUTION * np.abs(Q).max(0), scale, np.inf)


def _with_one(Q: np.ndarray) -> np.ndarray:
    """Append the constant to task parameters: [Q; 1]."""
    return np.concatenate([Q, np.ones((*Q.shape[:-1], 1))], axis=-1)


def _centres(maps: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Centres Z [Q; 1], (..., K, D), Eqs (48) and (80)."""
    return np.einsum("kda,...a->...kd", maps, Q)
