"""Other people's libraries on the same data, where they are installed."""

import importlib
import itertools
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import fit_gmm
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import gmr
from tpsim.section8.in_frames import BASIS, COMPONENTS
from tpsim.section8.method import Anchor, Frames, Learned, times_of, views_of
from tpsim.timeline import interpolate


def gmr_library(demonstrations: list[Demonstration]) -> Learned:
    """TP-GMM by the package gmr: one mixture over [t, all views], regression, then our product."""
    package = _library("gmr")
    times = times_of(demonstrations)
    parts = zip(*(views_of(d) for d in demonstrations), strict=True)
    views = [np.concatenate(part) for part in parts]
    time = np.concatenate([d.time for d in demonstrations])
    mixture = package.GMM(COMPONENTS, random_state=0)
    mixture.from_samples(np.column_stack([time, *views]), init_params="kmeans++")
    ends = np.cumsum([1, *(view.shape[1] for view in views)])
    local = []
    for first, last in itertools.pairwise(ends):
        dims = [0, *range(first, last)]
        covariances = mixture.covariances[:, dims][:, :, dims]
        part = package.GMM(COMPONENTS, mixture.priors, mixture.means[:, dims], covariances)
        at = [part.condition([0], [t]).to_mvn() for t in times]
        local.append(Gaussian(np.array([m.mean for m in at]), np.array([m.covariance for m in at])))

    def retrieve(frames: Frames) -> Gaussian:
        return fuse_frames(local, frames)

    n = 1 + sum(view.shape[1] for view in views)
    return Learned(retrieve, COMPONENTS * (1 + n * (n + 3) // 2) - 1)


def promp_library(demonstrations: list[Demonstration]) -> Learned:
    """ProMP by the package movement_primitives, conditioned on its start and its end."""
    library = _library("movement_primitives.promp")
    times = times_of(demonstrations)
    D = demonstrations[0].data.shape[1]
    model = library.ProMP(n_dims=D, n_weights_per_dim=BASIS)
    # The package scales the times that it is given in place.
    model.imitate([times.copy() for _ in demonstrations], [d.data for d in demonstrations])
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)

    def retrieve(frames: Frames) -> Gaussian:
        bent = model
        for t, point in ((0.0, start(frames)), (float(times[-1]), end(frames))):
            bent = bent.condition_position(
                point.mean, y_cov=point.covariance, t=t, t_max=float(times[-1])
            )
        variance = np.asarray(bent.var_trajectory(times.copy()))
        covariance = np.maximum(variance, 1e-9)[..., None] * np.eye(D)
        return Gaussian(np.asarray(bent.mean_trajectory(times.copy())), covariance)

    n = D * BASIS
    return Learned(retrieve, n * (n + 3) // 2)


def dmp_library(demonstrations: list[Demonstration]) -> Learned:
    """DMP by the package movement_primitives, of the first demonstration."""
    library = _library("movement_primitives.dmp")
    times = times_of(demonstrations)
    D = demonstrations[0].data.shape[1]
    model = library.DMP(
        n_dims=D, execution_time=float(times[-1]), dt=float(times[1]), n_weights_per_dim=BASIS
    )
    model.imitate(times, demonstrations[0].data)
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)

    def retrieve(frames: Frames) -> NDArray:
        model.configure(start_y=start(frames).mean, goal_y=end(frames).mean)
        when, path = model.open_loop(run_t=float(times[-1]))
        return interpolate(when, np.asarray(path), times)

    return Learned(retrieve, D * BASIS)


def kmp_library(demonstrations: list[Demonstration]) -> Learned:
    """KMP by the package lc-ns-kmp, from our mixture's regression, through its start and its end.

    With its defaults: regularisation, kernel over time from 0 to 1, no constraints.
    """
    library = _library("lc_ns_kmp")
    times = times_of(demonstrations)
    mixture = fit_gmm([d.with_time().data for d in demonstrations], COMPONENTS, start="time")
    taught, T = gmr(mixture, times), len(times)
    phase = np.linspace(0.0, 1.0, T)[:, None]
    model = library.LC_NS_KMP(taught.dim, T)
    start, end = Anchor.at(demonstrations, 0), Anchor.at(demonstrations, -1)

    def retrieve(frames: Frames) -> NDArray:
        mean, covariance = taught.mean.copy(), taught.covariance.copy()
        for t, point in ((0, start(frames)), (-1, end(frames))):
            mean[t], covariance[t] = point.mean, point.covariance
        return np.array(model.predict(phase, phase, mean, covariance))

    D = taught.dim
    return Learned(retrieve, T * D * (D + 3) // 2)


def _library(name: str) -> ModuleType:
    package = name.split(".")[0]
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ArgumentError(
            f"skipped, {error}: pip install {package.replace('lc_ns_kmp', 'lc-ns-kmp')}"
        ) from error
