"""Methods without frames: task parameters as inputs (Fig. 14), or a start and an end to meet."""

import numpy as np
from numpy.typing import NDArray

from tpsim.control.spring import damping_of, spring_damper
from tpsim.demonstration import Demonstration
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import fit_gmm
from tpsim.learning.pgmm import fit_pgmm, task_vector
from tpsim.retrieval.dmp import Motion, decay, forced_attractor, forcing_term
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.gp import SquaredExponential, fit_gp
from tpsim.retrieval.gp_gmm import fit_gp_gmm
from tpsim.retrieval.kmp import KMP
from tpsim.retrieval.promp import fit_promp
from tpsim.section8.in_frames import BASIS, COMPONENTS, KMP_LENGTH, KMP_POINTS
from tpsim.section8.method import Anchor, Frames, Learned, every, times_of

# The kernels of the tutorial's benchmarks, over task parameters.
TASK_TO_PATH = SquaredExponential(variance=0.5, length=2.24, noise=1e-2)
TASK_TO_MIXTURE = SquaredExponential(variance=1.0, length=2.24, noise=1e-3)
STIFFNESS = 150.0  # of a DMP that lasts 1 s [1/s^2]


def gpr(demonstrations: list[Demonstration]) -> Learned:
    """Gaussian process from task parameters to whole trajectories (Fig. 14, first row)."""
    T, D = demonstrations[0].data.shape
    tasks = [task_vector(d.frames) for d in demonstrations]
    process = fit_gp(tasks, [d.data.ravel() for d in demonstrations], TASK_TO_PATH)

    def retrieve(frames: Frames) -> Gaussian:
        task = [task_vector(every(frames))]
        variance = process.joint_covariance(task) * np.eye(D)
        return Gaussian(process(task).mean.reshape(T, D), np.tile(variance, (T, 1, 1)))

    return Learned(retrieve, process.inputs.size + process.outputs.size)


def gpr_gmm(demonstrations: list[Demonstration]) -> Learned:
    """Gaussian process from task parameters to mixtures (Fig. 14, second row)."""
    tasks = [task_vector(d.frames) for d in demonstrations]
    gmms = [fit_gmm(d.with_time().data, COMPONENTS, start="time") for d in demonstrations]
    process, times = fit_gp_gmm(tasks, gmms, TASK_TO_MIXTURE), times_of(demonstrations)
    stored = process.process.inputs.size + process.process.outputs.size
    return Learned(lambda frames: gmr(process(task_vector(every(frames))), times), stored)


def pgmm(demonstrations: list[Demonstration]) -> Learned:
    """Parametric mixture, its centres affine in the frames' positions (Fig. 14, third row).

    Positions alone, as in the tutorial's benchmark: more task parameters than demonstrations
    would not be determined.
    """

    def task_of(frames: Frames) -> NDArray:
        return np.concatenate([frame.b for frame in every(frames)])

    tasks = [task_of(d.frames) for d in demonstrations]
    timed = [d.with_time().data for d in demonstrations]
    model, times = fit_pgmm(timed, tasks, COMPONENTS, start="time"), times_of(demonstrations)
    return Learned(lambda frames: gmr(model.adapt(task_of(frames)), times), model.free_parameters)


def promp(demonstrations: list[Demonstration]) -> Learned:
    """ProMP in common coordinates, conditioned on where it starts and ends."""
    model = fit_promp([d.data for d in demonstrations], BASIS, weight_ridge=1e-3)
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)
    whole = model.distribution(len(times_of(demonstrations)))

    def retrieve(frames: Frames) -> Gaussian:
        path = whole
        for step, point in ((0, start(frames)), (-1, end(frames))):
            path = path.through(step, point.mean, point.covariance)
        return path.marginal()

    n = model.weights.dim
    return Learned(retrieve, n * (n + 3) // 2)


def kmp(demonstrations: list[Demonstration]) -> Learned:
    """KMP of the movement in common coordinates, bent through its start and its end."""
    times = times_of(demonstrations)
    mixture = fit_gmm([d.with_time().data for d in demonstrations], COMPONENTS, start="time")
    points = np.linspace(0.0, times[-1], min(KMP_POINTS, len(times)))
    taught = KMP(points, gmr(mixture, points), KMP_LENGTH * float(times[-1]))
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)

    def retrieve(frames: Frames) -> Gaussian:
        bent = taught
        for time, point in ((0.0, start(frames)), (float(times[-1]), end(frames))):
            bent = bent.through(time, point.mean, point.covariance)
        return bent(times)

    D = mixture.dim - 1
    return Learned(retrieve, len(points) * D * (D + 3) // 2)


def dmp(demonstrations: list[Demonstration]) -> Learned:
    """DMP of the demonstration whose situation is nearest, from the new start to the new goal.

    The forcing term with the start's part taken off [Hoffmann et al. 2009], so that it does not
    grow with the distance from start to goal.
    """
    times = times_of(demonstrations)
    dt, duration = float(times[1]), float(times[-1])
    stiffness = STIFFNESS / duration**2
    damping = damping_of(stiffness)
    s = decay(len(times), dt, 4.0 / duration)
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)
    motions = [Motion.of(d.data, dt) for d in demonstrations]
    forcings = [
        forcing_term(motion, motion.position[-1], s, stiffness, damping)
        + stiffness * (motion.position[-1] - motion.position[0])
        for motion in motions
    ]

    def retrieve(frames: Frames) -> NDArray:
        nearest = int(np.argmin([_distance(frames, d.frames) for d in demonstrations]))
        first, goal = start(frames).mean, end(frames).mean
        pushed = forcings[nearest] - stiffness * (goal - first)
        attractor = forced_attractor(goal, pushed, s, stiffness)
        initial = np.r_[first, motions[nearest].velocity[0]]
        return np.asarray(
            spring_damper(attractor, stiffness, damping, dt, initial).states[:, : len(goal)]
        )

    return Learned(retrieve, sum(forcing.size for forcing in forcings))


def _distance(a: Frames, b: Frames) -> float:
    """Distance of two situations over the frames that both see."""
    pairs = [(x, y) for x, y in zip(a, b, strict=True) if x is not None and y is not None]
    return float(sum(((task_vector([x]) - task_vector([y])) ** 2).sum() for x, y in pairs))
