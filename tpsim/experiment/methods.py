"""The eight ways of Section 8 to learn a movement that adapts to its situation.

Every method is a function that learns from demonstrations and returns how to retrieve the
movement in a situation: a function of its frames.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim.demonstration import Demonstration
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import fit_gmm
from tpsim.learning.pgmm import fit_pgmm, task_vector
from tpsim.learning.subspace import MFA, Structure
from tpsim.learning.tp_gmm import fit_tp_gmm
from tpsim.retrieval.distribution import fuse_frames
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.gp import SquaredExponential, fit_gp
from tpsim.retrieval.gp_gmm import fit_gp_gmm
from tpsim.retrieval.lwr import lwr
from tpsim.retrieval.trajectory import trajectory_of_states

Frames = Sequence[Frame]
Retrieve = Callable[[Frames], Gaussian]
"""From the frames of a situation to the movement: Gaussian (T, D)."""

COMPONENTS = 6

# The kernels of the tutorial's benchmarks: over time [s], over task parameters.
OVER_TIME = SquaredExponential(variance=10.0, length=0.0707, noise=1.0)
TASK_TO_PATH = SquaredExponential(variance=0.5, length=2.24, noise=1e-2)
TASK_TO_MIXTURE = SquaredExponential(variance=1.0, length=2.24, noise=1e-3)
WIDTH = 0.0316  # standard deviation of the weights of TP-LWR [s]


def tp_gmm(
    demonstrations: Sequence[Demonstration], covariance: str | Structure = "full"
) -> Retrieve:
    """TP-GMM over time, retrieved by GMR (Fig. 12, first row)."""
    timed = [d.with_time() for d in demonstrations]
    model = fit_tp_gmm(timed, COMPONENTS, covariance=covariance, start="time")
    times = timed[0].data[:, :1]
    return lambda frames: gmr(model.adapt([frame.with_input() for frame in frames]), times)


def tp_mfa(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """TP-GMM of mixtures of factor analyzers with one factor (Fig. 12, second row)."""
    return tp_gmm(demonstrations, MFA(1))


def tp_trajectory_gmm(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """TP-GMM over position, velocity and acceleration, without time (Fig. 12, third row)."""
    moving = [d.with_derivatives(2) for d in demonstrations]
    model = fit_tp_gmm(moving, COMPONENTS, start="time")
    dt = float(np.diff(moving[0].time).mean())
    share = model.responsibilities(moving).reshape(len(moving), -1, COMPONENTS)
    states = share.mean(0).argmax(1)

    def retrieve(frames: Frames) -> Gaussian:
        gmm = model.adapt([frame.with_derivatives(2) for frame in frames])
        return trajectory_of_states(gmm, states, dt)

    return retrieve


def tp_gp(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """Gaussian process over time in every frame, then their product (Fig. 13, first row)."""
    time, views, times = _in_frames(demonstrations)
    every = fit_gp(time, np.hstack(views), OVER_TIME).spread(times)
    columns = np.split(np.arange(every.dim), np.cumsum([view.shape[1] for view in views])[:-1])
    local = [every.marginal(dims) for dims in columns]
    return lambda frames: fuse_frames(local, frames)


def tp_lwr(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """Locally weighted regression in every frame, then their product (Fig. 13, second row)."""
    time, views, times = _in_frames(demonstrations)
    local = [lwr(time, view, times, WIDTH) for view in views]
    return lambda frames: fuse_frames(local, frames)


def gpr(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """Gaussian process from task parameters to whole trajectories (Fig. 14, first row)."""
    T, D = demonstrations[0].data.shape
    tasks = [task_vector(d.frames) for d in demonstrations]
    process = fit_gp(tasks, [d.data.ravel() for d in demonstrations], TASK_TO_PATH)

    def retrieve(frames: Frames) -> Gaussian:
        task = [task_vector(frames)]
        variance = process.joint_covariance(task) * np.eye(D)
        return Gaussian(process(task).mean.reshape(T, D), np.tile(variance, (T, 1, 1)))

    return retrieve


def gpr_gmm(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """Gaussian process from task parameters to mixtures (Fig. 14, second row)."""
    tasks = [task_vector(d.frames) for d in demonstrations]
    timed = [d.with_time().data for d in demonstrations]
    gmms = [fit_gmm(data, COMPONENTS, start="time") for data in timed]
    process = fit_gp_gmm(tasks, gmms, TASK_TO_MIXTURE)
    return lambda frames: gmr(process(task_vector(frames)), timed[0][:, :1])


def pgmm(demonstrations: Sequence[Demonstration]) -> Retrieve:
    """Parametric mixture, its centres affine in the frames' positions (Fig. 14, third row).

    Positions alone, as in the tutorial's benchmark: more task parameters than demonstrations
    would not be determined.
    """

    def task_of(frames: Frames) -> np.ndarray:
        return np.concatenate([frame.b for frame in frames])

    tasks = [task_of(d.frames) for d in demonstrations]
    timed = [d.with_time().data for d in demonstrations]
    model = fit_pgmm(timed, tasks, COMPONENTS, start="time")
    return lambda frames: gmr(model.adapt(task_of(frames)), timed[0][:, :1])


METHODS: dict[str, Callable[[Sequence[Demonstration]], Retrieve]] = {
    "TP-GMM": tp_gmm,
    "TP-MFA": tp_mfa,
    "TP-trajGMM": tp_trajectory_gmm,
    "TP-GP": tp_gp,
    "TP-LWR": tp_lwr,
    "GPR": gpr,
    "GPR-GMM": gpr_gmm,
    "PGMM": pgmm,
}
"""Names of Figs 12 to 14, in their order."""


def _in_frames(demonstrations: Sequence[Demonstration]):
    """Times of all samples (N,), what each frame saw (N, d_j), and the times to retrieve (T,)."""
    time = np.concatenate([d.time - d.time[0] for d in demonstrations])
    views = zip(*(d.observations for d in demonstrations), strict=True)
    first = demonstrations[0].time
    return time, [np.concatenate(view) for view in views], first - first[0]
