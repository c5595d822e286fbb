"""Methods that see a movement from every frame: Figs 12 and 13, and their relatives."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from tpsim.control.lqt import lqt
from tpsim.control.system import integrator
from tpsim.demonstration import Demonstration
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.subspace import HDDC, MFA, MPPCA, Structure
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.distribution import (
    TPTrajectoryDistribution,
    fit_tp_trajectory_distribution,
)
from tpsim.retrieval.fit_movement import fit_movement
from tpsim.retrieval.fit_tp_gmr import fit_tp_gmr
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.gp import SquaredExponential, fit_gp
from tpsim.retrieval.kmp import KMP
from tpsim.retrieval.lwr import lwr
from tpsim.retrieval.promp import TPProMP, fit_tp_promp
from tpsim.retrieval.tp_gmr import Order
from tpsim.retrieval.trajectory import trajectory_of_states
from tpsim.section8.method import Frames, Learned, Method, times_of, views_of

View = TypeVar("View")

COMPONENTS = 6
"""Number of components where a method does not choose it itself."""

BASIS = 12
"""Basis functions of a ProMP."""

# Of the tutorial's benchmarks, which last 2 s; lengths as shares of the duration.
GP_VARIANCE, GP_LENGTH, GP_NOISE = 10.0, 0.0354, 1.0
LWR_WIDTH = 0.0158
KMP_LENGTH = 0.1
KMP_POINTS = 40
EFFORT = 1e-4


def tp_gmm(demonstrations: list[Demonstration]) -> Learned:
    """TP-GMM with our defaults: structure, order and K by the demonstrations (fit_movement)."""
    movement = fit_movement(demonstrations)
    return Learned(movement, movement.model.free_parameters)


def tp_gmr(demonstrations: list[Demonstration]) -> Learned:
    """TP-GMM over time and GMR with our defaults (fit_tp_gmr)."""
    movement = fit_tp_gmr(demonstrations)
    return Learned(movement, movement.model.free_parameters)


def tp_gmr_with(covariance: str | Structure, order: Order = "regression") -> Method:
    """TP-GMM over time of a given structure, retrieved by GMR in a given order."""

    def learn(demonstrations: list[Demonstration]) -> Learned:
        movement = fit_tp_gmr(demonstrations, COMPONENTS, covariance=covariance, order=order)
        return Learned(movement, movement.model.free_parameters)

    return learn


tp_mfa = tp_gmr_with(MFA(1))
tp_hddc = tp_gmr_with(HDDC(1))
tp_mppca = tp_gmr_with(MPPCA(1))


def tp_trajectory_gmm(demonstrations: list[Demonstration]) -> Learned:
    """TP-GMM over position, velocity and acceleration, without time (Fig. 12, third row)."""
    moving = [d.with_derivatives(2) for d in demonstrations]
    model = fit_tp_gmm(moving, COMPONENTS, start="time")
    times = times_of(demonstrations)
    states = _states(model, moving)

    def retrieve(frames: Frames) -> Gaussian:
        lifted = [frame if frame is None else frame.with_derivatives(2) for frame in frames]
        return trajectory_of_states(model.adapt(lifted), states, float(times[1]))

    return Learned(retrieve, model.free_parameters)


def tp_lqt(demonstrations: list[Demonstration]) -> Learned:
    """Optimal control of a double integrator in several frames, Eq. 38."""
    moving = [d.with_derivatives(1) for d in demonstrations]
    model = fit_tp_gmm(moving, COMPONENTS, start="time")
    times = times_of(demonstrations)
    states = _states(model, moving)
    system = integrator(demonstrations[0].data.shape[1], float(times[1]))

    def retrieve(frames: Frames) -> NDArray:
        lifted = [frame if frame is None else frame.with_derivatives(1) for frame in frames]
        reference = model.adapt(lifted).gaussians[states]
        feedback = lqt(reference.mean, reference.precision, system, EFFORT)
        plan = feedback.rollout(reference.mean[0])
        return np.asarray(plan.states[:, : system.B.shape[1]])

    return Learned(retrieve, model.free_parameters)


def tp_gp(demonstrations: list[Demonstration]) -> Learned:
    """Gaussian process over time in every frame, then their product (Fig. 13, first row)."""
    time, views, times = _samples(demonstrations)
    kernel = SquaredExponential(GP_VARIANCE, GP_LENGTH * float(times[-1]), GP_NOISE)
    everything = fit_gp(time, np.hstack(views), kernel).spread(times)
    columns = np.split(np.arange(everything.dim), np.cumsum([v.shape[1] for v in views])[:-1])
    local = [everything.marginal(list(dims)) for dims in columns]
    return Learned(lambda frames: _fuse(local, frames), _stored(demonstrations))


def tp_lwr(demonstrations: list[Demonstration]) -> Learned:
    """Locally weighted regression in every frame, then their product (Fig. 13, second row)."""
    time, views, times = _samples(demonstrations)
    width = max(LWR_WIDTH * float(times[-1]), 1.5 * float(times[1]))
    local = [lwr(time, view, times, width) for view in views]
    return Learned(lambda frames: _fuse(local, frames), _stored(demonstrations))


def tp_kmp(demonstrations: list[Demonstration]) -> Learned:
    """Kernelized movement primitive in every frame, then their product."""
    times = times_of(demonstrations)
    model = fit_tp_gmm([d.with_time() for d in demonstrations], COMPONENTS, start="time")
    points = np.linspace(0.0, times[-1], min(KMP_POINTS, len(times)))
    length = KMP_LENGTH * float(times[-1])
    local = [
        KMP(points, gmr(GMM(model.priors, frame), points), length)(times) for frame in model.frames
    ]
    size = sum(len(points) * d * (d + 3) // 2 for d in (view.dim for view in local))
    return Learned(lambda frames: _fuse(local, frames), size)


def tp_promp(demonstrations: list[Demonstration]) -> Learned:
    """Probabilistic movement primitive in every frame; the product is taken on the weights."""
    model = fit_tp_promp(demonstrations, BASIS, weight_ridge=1e-3)
    steps = len(times_of(demonstrations))

    def retrieve(frames: Frames) -> Gaussian:
        learned, seen = _seen(model.frames, frames)
        return TPProMP(learned).adapt(seen).distribution(steps).marginal()

    dims = [frame.weights.dim for frame in model.frames]
    return Learned(retrieve, sum(n * (n + 3) // 2 for n in dims))


def tp_trajectory_distribution(demonstrations: list[Demonstration]) -> Learned:
    """Gaussian of whole trajectories in every frame, by three eigencomponents."""
    modes = min(3, len(demonstrations) - 1)
    model = fit_tp_trajectory_distribution(demonstrations, modes, noise=1e-2)

    def retrieve(frames: Frames) -> Gaussian:
        learned, seen = _seen(model.frames, frames)
        return TPTrajectoryDistribution(learned).adapt(seen).marginal()

    return Learned(retrieve, sum(v.mean.size + v.modes.size for v in model.frames))


def _states(model: TPGMM, demonstrations: Sequence[Demonstration]) -> NDArray:
    """Likeliest component (T,) of every step, of all demonstrations together."""
    share = model.responsibilities(demonstrations)
    each = share.reshape(len(demonstrations), -1, model.components)
    return np.asarray(each.mean(0).argmax(1))


def _samples(
    demonstrations: Sequence[Demonstration],
) -> tuple[NDArray, list[NDArray], NDArray]:
    """Times of all samples (N,), what each frame saw (N, d_j), and the times to retrieve (T,)."""
    time = np.concatenate([d.time for d in demonstrations])
    views = zip(*(views_of(d) for d in demonstrations), strict=True)
    return time, [np.concatenate(view) for view in views], times_of(demonstrations)


def _stored(demonstrations: Sequence[Demonstration]) -> int:
    """Numbers that a method keeps that keeps all samples."""
    return sum(d.time.size + sum(view.size for view in views_of(d)) for d in demonstrations)


def _seen(learned: Sequence[View], frames: Frames) -> tuple[tuple[View, ...], list[Frame]]:
    """What was learned in the frames that are observed, and these frames."""
    pairs = [(v, f) for v, f in zip(learned, frames, strict=True) if f is not None]
    return tuple(view for view, _ in pairs), [frame for _, frame in pairs]


def _fuse(local: Sequence[Gaussian], frames: Frames) -> Gaussian:
    return fuse_frames(local, frames)
