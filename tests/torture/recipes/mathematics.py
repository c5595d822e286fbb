"""Good calls of the mathematics: ``import tpsim``."""

import tempfile
from pathlib import Path

import numpy as np
from recipe import Book

import tpsim as tp
from tpsim import projection, rotation
from tpsim.learning.eigenframes import Eigenframes
from tpsim.learning.multilinear import CP, Tucker
from tpsim.learning.redundancy import Redundancy
from tpsim.learning.relevance import FrameReport
from tpsim.learning.selection import Selection
from tpsim.retrieval.gp_gmm import MixtureProcess

RNG = np.random.default_rng(5)
T = 12
TIME = np.linspace(0.0, 1.0, T)
DATES = {"date", "duration", "numpy date", "dates", "durations"}
FOLDER = Path(tempfile.mkdtemp(prefix="torture-"))


def path(k: int) -> np.ndarray:
    """Movement (T, 2), one of several."""
    return np.column_stack([TIME + 0.1 * k, np.sin(3 * TIME + 0.2 * k)]) + 0.02 * RNG.normal(
        size=(T, 2)
    )


def frames(k: int) -> tuple[tp.Frame, tp.Frame]:
    """Two frames in the plane."""
    c, s = np.cos(0.3 * k), np.sin(0.3 * k)
    return tp.Frame(np.eye(2), [0.0, 0.1 * k]), tp.Frame([[c, -s], [s, c]], [1.0, 0.2 * k])


PATHS = [path(k) for k in range(3)]
DEMONSTRATIONS = [tp.Demonstration(TIME, PATHS[k], frames(k), name=f"d{k}") for k in range(3)]
TIMED = [d.with_time() for d in DEMONSTRATIONS]
FRAMES, TIMED_FRAMES = list(frames(4)), [f.with_input() for f in frames(4)]
GAUSSIAN = tp.Gaussian([0.1, 0.2], [[1.0, 0.2], [0.2, 0.5]])
SEVERAL = tp.Gaussian(RNG.normal(size=(3, 2)), [np.eye(2) * s for s in (0.5, 1.0, 2.0)])
GMM = tp.fit_gmm(TIMED, 2, rng=0)
TPGMM = tp.fit_tp_gmm(TIMED, 2, rng=0)
PLACES = tp.fit_tp_gmm(DEMONSTRATIONS, 2, rng=0)
HMM = tp.fit_hmm(PATHS, 2, rng=0)
TPHMM = tp.fit_hmm(DEMONSTRATIONS, 2, rng=0)
HSMM = tp.fit_hsmm(PATHS, 2, rng=0)
CHAIN, SEMI = HMM.chain, HSMM.chain
SYSTEM = tp.integrator(2, 0.1)
MEANS, PRECISIONS = RNG.normal(size=(5, 4)), np.tile(np.diag([4.0, 3.0, 0.5, 0.2]), (5, 1, 1))
FEEDBACK = tp.lqt(MEANS, PRECISIONS, SYSTEM, 0.1)
REGULATOR = tp.lqr(SYSTEM, np.eye(4), np.eye(2))
PLANAR = tp.PlanarChain([1.0, 0.5, 0.7])
Q = np.array([0.2, 0.5, -0.3])
PGMM = tp.fit_pgmm(PATHS, [[0.0, 1.0], [1.0, 0.2], [0.5, 0.7]], 2, rng=0)
DISTRIBUTION = tp.fit_trajectory_distribution(np.stack(PATHS), 2)
TPDISTRIBUTION = tp.fit_tp_trajectory_distribution(DEMONSTRATIONS, 2)
PROMP, TPPROMP = tp.fit_promp(PATHS, 3), tp.fit_tp_promp(DEMONSTRATIONS, 3)
MOTION = tp.Motion.of(PATHS[0], 0.1)
KERNEL = tp.SquaredExponential(1.0, 0.3, 0.1)
PROCESS = tp.fit_gp(TIME, PATHS[0], KERNEL)
STATES = tp.fit_tp_gmm([d.with_derivatives(2) for d in DEMONSTRATIONS], 2, rng=0).adapt(
    [f.with_derivatives(2) for f in FRAMES]
)
TASKS, MIXTURES = np.array([[0.0], [0.5], [1.0]]), [tp.fit_gmm(p, 2, start="time") for p in PATHS]
ROTATIONS = rotation.exp(np.array([[0.1, 0.2, 0.3], [0.4, -0.2, 0.1], [0.0, 0.1, -0.5]]))
QUATERNIONS = rotation.to_quaternion(ROTATIONS)
REGRESSION = tp.Regression.of(GMM, (0,))
TPGMR = tp.fit_tp_gmr(DEMONSTRATIONS, 2)
TPTRAJECTORY = tp.fit_tp_trajectory(DEMONSTRATIONS, 2)
KMP = tp.KMP(TIME, tp.Gaussian(PATHS[0], 0.1 * np.eye(2)), 0.2)
POSE, PLACES_IN_SPACE = tp.R(3) * tp.S3, np.ones((5, 3))
STRUCTURES = {"covariance": set()}


def book() -> Book:
    """All of them."""
    book = Book()
    for chapter in (
        _values,
        _manifolds,
        _learning,
        _hidden,
        _retrieval,
        _processes,
        _control,
        _geometry,
    ):
        chapter(book)
    return book


def _values(book: Book) -> None:
    add = book.add
    add("Frame", tp.Frame, A=np.eye(2), b=np.zeros(2))
    add("Frame", tp.Frame, A=np.tile(np.eye(2), (3, 1, 1)), b=np.zeros((3, 2)))
    frame = tp.Frame([[0.0, -2.0], [2.0, 0.0]], [1.0, 2.0])
    moving = tp.Frame(np.tile(np.eye(2), (3, 1, 1)), np.ones((3, 2)))
    add("Frame.__getitem__", moving.__getitem__, index=1, takes={"index": {"slice", "ellipsis"}})
    add("Frame.to_common", frame.to_common, x=PATHS[0])
    add("Frame.to_local", frame.to_local, x=PATHS[0])
    add("Frame.to_local", moving.to_local, x=np.ones((3, 2)))
    add("Frame.uncertainty", frame.uncertainty, x=PATHS[0], origin=0.1 * np.eye(2), orientation=0.1)
    add("Frame.with_derivatives", frame.with_derivatives, n=2)
    add("Frame.with_input", frame.with_input, n=1)
    add("Gaussian", tp.Gaussian, mean=np.zeros(2), covariance=np.eye(2))
    add("Gaussian", tp.Gaussian, mean=np.zeros((3, 2)), covariance=np.tile(np.eye(2), (3, 1, 1)))
    add(
        "Gaussian.__getitem__", SEVERAL.__getitem__, index=1, takes={"index": {"slice", "ellipsis"}}
    )
    add("Gaussian.affine", GAUSSIAN.affine, A=np.array([[1.0, 2.0], [0.5, 1.0]]), b=np.ones(2))
    add("Gaussian.condition", GAUSSIAN.condition, value=np.array([0.3]), given=0, of=[1])
    add("Gaussian.log_density", SEVERAL.log_density, x=np.ones((3, 2)))
    add("Gaussian.marginal", GAUSSIAN.marginal, dims=[0])
    add("Gaussian.sample", GAUSSIAN.sample, rng=0, size=3)
    add("Gaussian.sample", GAUSSIAN.sample, rng=0, size=(2, 3))
    add("gaussian_product", tp.gaussian_product, gaussians=[GAUSSIAN, SEVERAL[0]])
    add("match_moments", tp.match_moments, weights=np.array([0.2, 0.3, 0.5]), gaussian=SEVERAL)
    add("add_ridge", tp.add_ridge, covariance=np.eye(2), rho=0.1)
    add("floor_eigenvalues", tp.floor_eigenvalues, covariance=np.eye(2), minimum=0.1)
    add(
        "Demonstration",
        tp.Demonstration,
        takes={"time": DATES, "name": {"*"}},
        free=("name",),
        time=TIME,
        data=PATHS[0],
        frames=FRAMES,
        observations=[PATHS[1], PATHS[2]],
        name="d",
    )
    add(
        "Demonstration.from_poses",
        tp.Demonstration.from_poses,
        takes={"time": DATES},
        time=TIME[:3],
        positions=np.ones((3, 3)),
        orientations=QUATERNIONS,
        convention="wxyz",
        degrees=False,
        frames=(),
        observations=None,
        name="d",
        free=("name",),
    )
    add(
        "Demonstration.from_poses",
        tp.Demonstration.from_poses,
        takes={"time": DATES},
        time=TIME[:3],
        positions=np.ones((3, 3)),
        orientations=ROTATIONS,
        convention="matrix",
    )
    add(
        "Demonstration.from_poses",
        tp.Demonstration.from_poses,
        takes={"time": DATES},
        time=TIME[:3],
        positions=np.ones((3, 3)),
        orientations=np.ones((3, 3)),
        convention="xyz",
        degrees=True,
    )
    add("Demonstration.resampled", DEMONSTRATIONS[0].resampled, times=7, smooth=True)
    add("Demonstration.resampled", DEMONSTRATIONS[0].resampled, times=TIME[2:5], smooth=False)
    add("Demonstration.with_derivatives", DEMONSTRATIONS[0].with_derivatives, n=2)
    add("Demonstration.with_time", DEMONSTRATIONS[0].with_time, input=TIME)
    add("agree", tp.agree, demonstrations=DEMONSTRATIONS, quaternions=None, angles=[1])
    saved = GAUSSIAN.save(FOLDER / "gaussian.npz")
    add("Stored.save", GAUSSIAN.save, words=("exists",), path=str(FOLDER / "again.npz"))
    add("Stored.load", tp.Gaussian.load, words=("file",), path=str(saved))
    add("load", tp.load, words=("file",), path=str(saved))


def _manifolds(book: Book) -> None:
    add = book.add
    add("R", tp.R, n=3, moves="vectors")
    add("Manifold", tp.Manifold, spaces=POSE.spaces)
    add("Manifold.mirrored", POSE.mirrored, axis="y")
    two = np.hstack([PLACES_IN_SPACE[:3], QUATERNIONS])
    words = ("x has", "y has", "points")
    add("Manifold.log", POSE.log, words=words, x=two, y=two[::-1].copy())
    add("Manifold.exp", POSE.exp, words=words, x=two, v=np.full((3, 6), 0.1))
    add("Manifold.transport", POSE.transport, words=words, x=two, y=two[::-1].copy())
    add("Manifold.distance", POSE.distance, words=words, x=two, y=two[::-1].copy())
    add("Manifold.frame", POSE.frame, words=("A",), frame=tp.Frame(np.eye(3), np.ones(3)))
    add("RiemannianGaussian", tp.RiemannianGaussian, manifold=POSE, mean=two, covariance=np.eye(6))
    g = tp.RiemannianGaussian(POSE, two, 0.1 * np.eye(6))
    add("RiemannianGaussian.__getitem__", g.__getitem__, index=1,
        takes={"index": {"slice", "ellipsis"}})  # fmt: skip
    add("RiemannianGaussian.log", g.log, x=two)
    add("RiemannianGaussian.log_density", g.log_density, x=two)
    add("RiemannianGaussian.sample", g.sample, rng=0, size=2)
    add("RiemannianGaussian.marginal", g.marginal, dims=[0, 2])
    add("RiemannianGaussian.condition", g.condition, words=("points", "x"), value=np.array([0.3]),
        given=0, of=[1])  # fmt: skip
    lifted = POSE.frame(tp.Frame(np.eye(3), np.ones(3)))
    add("RiemannianGaussian.affine", g.affine, words=("frame",), A=lifted.A.copy(),
        b=lifted.b.copy())  # fmt: skip
    add("Unrolled.of", tp.Unrolled.of, words=("points",), manifold=POSE, points=two)
    path = tp.Unrolled.of(POSE, two)
    add("Unrolled", tp.Unrolled, manifold=POSE, points=two, axes=path.axes.copy(),
        plane=path.plane.copy())  # fmt: skip
    add("Unrolled.see", path.see, step=1, point=two[0])
    add("Unrolled.roll", path.roll, step=1, plane=np.full(6, 0.1))
    add("Unrolled.rolled", path.rolled, plane=np.full((3, 6), 0.1))
    add("Unrolled.place", path.place, gaussian=g)
    system = tp.integrator(6, 0.1)
    plan = tp.lqt_on(g, system, 0.1)
    add("lqt_on", tp.lqt_on, words=("points", "precisions"), reference=g, system=system, effort=0.1,
        initial=two[0])  # fmt: skip
    add("ManifoldPlan", tp.ManifoldPlan, path=plan.path, feedback=plan.feedback)
    add("ManifoldPlan.acceleration", plan.acceleration, words=("point",), step=1, point=two[0],
        velocity=np.zeros(6))  # fmt: skip
    add("ManifoldPlan.rollout", plan.rollout, words=("point", "initial", "velocity"), point=two[0],
        velocity=np.zeros(6))  # fmt: skip


def _learning(book: Book) -> None:
    add = book.add
    few = {"tolerance": 1e-3, "max_iterations": 5}
    add("low_pass", tp.low_pass, time=TIME, values=PATHS[0], cutoff=4.0, takes={"time": DATES})
    add(
        "effective_samples",
        tp.effective_samples,
        takes={"demonstrations": {"ragged"}},  # sequences have lengths of their own
        words=("sample",),
        demonstrations=PATHS,
        of="mean",
    )
    add("deviation_interval", tp.deviation_interval, infinite=True, samples=9.0, confidence=0.95)
    add(
        "demonstrations_wanted",
        tp.demonstrations_wanted,
        takes={"demonstrations": {"ragged"}},
        words=("sample",),
        demonstrations=PATHS,
        within=2.0,
        confidence=0.95,
    )
    add(
        "fit_gmm",
        tp.fit_gmm,
        words=("sample",),
        data=PATHS[0],
        components=2,
        covariance="full",
        start="kmeans",
        ridge=1e-4,
        restarts=1,
        time=TIME,
        rng=0,
        **few,
        takes={"time": DATES, "start": {"*"}, "tolerance": {"-inf"}},
    )
    add(
        "fit_gmm",
        tp.fit_gmm,
        words=("sample",),
        data=PATHS,
        components=2,
        covariance="diagonal",
        start="time",
    )
    add(
        "fit_gmm",
        tp.fit_gmm,
        words=("sample",),
        data=DEMONSTRATIONS,
        components=2,
        covariance=tp.MFA(1),
    )
    add(
        "fit_tp_gmm",
        tp.fit_tp_gmm,
        words=("observation", "sample", "component"),
        demonstrations=DEMONSTRATIONS,
        components=2,
        covariance="full",
        start="time",
        ridge=1e-4,
        restarts=1,
        rng=0,
        **few,
        takes={"tolerance": {"-inf"}},
    )
    add(
        "fit_tp_gmm",
        tp.fit_tp_gmm,
        words=("observation", "sample", "component"),
        demonstrations=PATHS,
        components=2,
        covariance=tp.HDDC(1),
        observed=np.arange(3 * len(PATHS[0])).reshape(-1, 3) % 5 > 0,
    )
    add(
        "update_tp_gmm",
        tp.update_tp_gmm,
        words=("observation", "sample"),
        model=TPGMM,
        demonstrations=TIMED[:1],
        **_signature_of_update(),
    )
    add(
        "TPGMM",
        tp.TPGMM,
        priors=np.array([0.4, 0.6]),
        frames=[SEVERAL[:2], SEVERAL[1:]],
        history=np.array([1.0, 2.0]),
        samples=10,
    )
    add(
        "TPGMM.adapt",
        PLACES.adapt,
        words=("frames lead", "covariance"),
        frames=FRAMES,
        ridge=1e-4,
        prior=GAUSSIAN,
        uncertainty=[np.eye(2), None],
    )
    for method in ("log_joint", "log_likelihood", "responsibilities"):
        add(
            f"TPGMM.{method}",
            getattr(PLACES, method),
            words=("demonstration",),
            observations=DEMONSTRATIONS,
        )
        add(
            f"TPGMM.{method}",
            getattr(PLACES, method),
            words=("demonstration",),
            observations=[PATHS[0], PATHS[1]],
        )
        add(f"GMM.{method}", getattr(GMM, method), x=TIMED[0].data)
    add(
        "GMM",
        tp.GMM,
        priors=np.array([0.4, 0.6]),
        gaussians=SEVERAL[:2],
        history=np.array([1.0, 2.0]),
        samples=10,
    )
    add("GMM.__getitem__", STEPS.__getitem__, index=1, takes={"index": {"slice", "ellipsis"}})
    add("GMM.sample", GMM.sample, rng=0, size=3)
    add(
        "fit_pgmm",
        tp.fit_pgmm,
        words=("component", "sample"),
        sequences=PATHS,
        components=2,
        rng=0,
        **few,
        takes={"tolerance": {"-inf"}},
        **{PGMM_PARAMETERS: np.array([[0.0, 1.0], [1.0, 0.2], [0.5, 0.7]])},
    )
    add(
        "PGMM",
        tp.PGMM,
        priors=np.ones(1),
        maps=np.zeros((1, 2, 3)),
        covariance=np.eye(2)[None],
        history=np.array([1.0]),
    )
    add("PGMM.adapt", PGMM.adapt, parameters=np.array([0.1, 0.2]))
    for method in ("log_likelihood", "responsibilities"):
        add(f"PGMM.{method}", getattr(PGMM, method), data=PATHS[0], parameters=np.array([0.1, 0.2]))
    add("task_vector", tp.task_vector, frames=FRAMES)
    add(
        "aic",
        lambda model, data: tp.aic(model, data),
        words=("x", "sample"),
        model=GMM,
        data=TIMED[0].data,
    )
    add(
        "bic",
        lambda model, data: tp.bic(model, data),
        words=("observation", "demonstration", "sample", "K and one"),
        model=PLACES,
        data=DEMONSTRATIONS,
    )
    add("dp_means", tp.dp_means, points=PATHS[0], radius=0.5)
    add(
        "dp_means_start",
        tp.dp_means_start,
        words=("observation", "demonstration", "sample", "K and one"),
        data=DEMONSTRATIONS,
        radius=0.5,
    )
    add(
        "select_model",
        tp.select_model,
        words=("observation", "demonstration", "sample", "K and one"),
        data=DEMONSTRATIONS,
        components=[1, 2],
        covariances=("full", "diagonal"),
        criterion="bic",
        start="time",
    )
    add(
        "select_model",
        tp.select_model,
        words=("observation", "demonstration", "sample", "K and one"),
        data=PATHS[0],
        components=range(1, 3),
        fit=tp.fit_gmm,
        covariances=("full",),
        criterion="aic",
    )
    add(
        "shrink_directions",
        tp.shrink_directions,
        model=TPGMM,
        demonstrations=3,
        given=(0,),
        blocks=1,
    )
    add(
        "frame_relevance",
        tp.frame_relevance,
        words=("frame",),
        model=PLACES,
        demonstration=DEMONSTRATIONS[0],
        dims=[0, 1],
    )
    add(
        "frame_report",
        tp.frame_report,
        words=("frame",),
        model=PLACES,
        demonstrations=DEMONSTRATIONS,
        dims=[0],
        significance=0.05,
        draws=20,
        rng=0,
    )
    _multilinear(book)
    add("frame_shares", tp.frame_shares, model=PLACES, frames=FRAMES, dims=[0])
    for structure in (tp.HDDC, tp.MFA, tp.MPPCA):
        add(structure.__name__, structure, dimension=1)
        for owner in ("_Subspace", "MFA"):
            add(f"{owner}.free_parameters", structure(1).free_parameters, dim=4)
        add("_Subspace.subspace", structure(1).subspace, dim=4)
    add("dtw", tp.dtw, words=("cost",), reference=PATHS[0], other=PATHS[1], band=4)
    add("Warp", tp.Warp, path=np.array([[0, 0], [1, 1]]), cost=1.0)
    add("align", tp.align, demonstrations=DEMONSTRATIONS, reference=0, band=4, by="data", rounds=2)
    add("on_one_clock", tp.on_one_clock, demonstrations=DEMONSTRATIONS, samples=9)
    add(
        "FrameReport",
        FrameReport,
        **_fields(FrameReport, tp.frame_report(PLACES, DEMONSTRATIONS, draws=20)),
    )
    add(
        "Selection",
        Selection,
        **_fields(Selection, tp.select_model(PATHS[0], [1, 2], fit=tp.fit_gmm)),
    )


def _multilinear(book: Book) -> None:
    add = book.add
    add("Demonstration.seen_from", DEMONSTRATIONS[0].seen_from, frames=[1, 0])
    add("demonstration_tensor", tp.demonstration_tensor, demonstrations=DEMONSTRATIONS, samples=5)
    add(
        "eigenframes",
        tp.eigenframes,
        demonstrations=DEMONSTRATIONS,
        ranks=(2, 2, 2, 2),
        samples=6,
        share=0.9,
    )
    add(
        "redundant_frames",
        tp.redundant_frames,
        demonstrations=DEMONSTRATIONS,
        samples=6,
        tolerance=0.1,
    )
    tensor = RNG.normal(size=(3, 2, 4))
    limits = {"tolerance": 1e-6, "max_iterations": 5}
    add("tucker", tp.tucker, tensor=tensor, ranks=[2, 2, 3], share=0.9, **limits)
    add("cp", tp.cp, tensor=tensor, rank=2, rng=0, **limits)
    for kind, found in (
        (Tucker, tp.tucker(tensor, [2, 2, 3])),
        (CP, tp.cp(tensor, 2, max_iterations=5)),
        (Eigenframes, tp.eigenframes(DEMONSTRATIONS, samples=6)),
        (Redundancy, tp.redundant_frames(DEMONSTRATIONS, samples=6)),
    ):
        add(kind.__name__, kind, **_fields(kind, found))


STEPS = PLACES.adapt([tp.Frame(np.tile(np.eye(2), (3, 1, 1)), np.zeros(2)), FRAMES[1]])
PGMM_PARAMETERS = "parameters"


def _signature_of_update() -> dict[str, object]:
    return {"retention": 0.9}


def _fields(kind: type, value: object) -> dict[str, object]:
    """Fields of a value as arguments of its class."""
    import dataclasses

    return {
        field.name: getattr(value, field.name) for field in dataclasses.fields(kind) if field.init
    }


def _hidden(book: Book) -> None:
    add = book.add
    few = {"tolerance": 1e-3, "max_iterations": 5}
    for name, fit in (("fit_hmm", tp.fit_hmm), ("fit_hsmm", tp.fit_hsmm)):
        add(
            name,
            fit,
            words=("data", "sample", "demonstration", "component"),
            sequences=PATHS,
            components=2,
            topology="left-right",
            covariance="full",
            start="time",
            ridge=1e-4,
            rng=0,
            **few,
            takes={"tolerance": {"-inf"}},
        )
        add(
            name,
            fit,
            words=("data", "sample", "demonstration", "component"),
            sequences=DEMONSTRATIONS,
            components=2,
            topology="any",
        )
    add("HMM", tp.HMM, chain=CHAIN, emissions=HMM.emissions, history=np.array([1.0]))
    add("HSMM", tp.HSMM, chain=SEMI, emissions=HMM.emissions, history=np.array([1.0]))
    add(
        "HiddenStates.adapt",
        TPHMM.adapt,
        words=("frames lead", "covariance"),
        frames=FRAMES,
        ridge=1e-4,
        prior=GAUSSIAN,
    )
    for method in ("forward", "log_densities", "log_likelihood", "responsibilities", "viterbi"):
        for model in (HMM, HSMM):
            add(
                f"HiddenStates.{method}",
                getattr(model, method),
                words=("demonstration",),
                observations=PATHS[0],
            )
        add(
            f"HiddenStates.{method}",
            getattr(TPHMM, method),
            words=("demonstration",),
            observations=DEMONSTRATIONS[0],
        )
        add(
            f"HiddenStates.{method}",
            getattr(TPHMM, method),
            words=("demonstration",),
            observations=[PATHS[0], PATHS[1]],
        )
    for model, chain in ((HMM, CHAIN), (HSMM, SEMI)):
        owner = type(chain).__name__
        add("HiddenStates.sample_states", model.sample_states, steps=5, rng=0)
        add("HiddenStates.state_probabilities", model.state_probabilities, steps=5)
        add("HiddenStates.state_sequence", model.state_sequence, steps=5)
        add(f"{owner}.probabilities", chain.probabilities, steps=5)
        add(f"{owner}.sample", chain.sample, steps=5, rng=0)
    add("SemiMarkovChain.along", tp.SemiMarkovChain.along, states=np.array([0, 0, 1]), spread=0.1)
    add(
        "SemiMarkovChain.through",
        tp.SemiMarkovChain.through,
        words=("sequences",),
        sequences=[np.array([0, 0, 1]), np.array([1, 2])],
        components=3,
        spread=0.1,
    )
    add("Pace", tp.Pace, words=("pace",), likely=np.array([0.1, 0.8, 0.1]), lasting=0.5)
    add("ProgressFilter", tp.ProgressFilter, chain=SEMI, pace=tp.Pace())
    progress = tp.ProgressFilter(SEMI)
    belief = progress.start(np.zeros(2))
    add("ProgressFilter.start", progress.start, log_densities=np.zeros(2))
    add("ProgressFilter.update", progress.update, belief=belief, log_densities=np.zeros(2))
    add("ProgressFilter.foreseen", progress.foreseen, belief=belief)
    add("ProgressFilter.states_ahead", progress.states_ahead, belief=belief, steps=5, rng=0)
    stays = tp.SemiMarkovChain.along(np.repeat([0, 1], 3))
    places = tp.Gaussian(np.zeros((6, 2)), np.tile(np.eye(2), (6, 1, 1)))
    add("Passage", tp.Passage, chain=stays, places=places, dt=0.1, speed_deviation=0.2)
    add(
        "MarkovChain",
        tp.MarkovChain,
        initial=np.array([1.0, 0.0]),
        transitions=np.full((2, 2), 0.5),
    )
    add("MarkovChain.of", tp.MarkovChain.of, components=3, topology="left-right", stay=4.0)
    add(
        "SemiMarkovChain",
        tp.SemiMarkovChain,
        initial=np.array([1.0, 0.0]),
        transitions=np.array([[0.0, 1.0], [1.0, 0.0]]),
        durations=tp.Gaussian([[4.0], [5.0]], np.ones((2, 1, 1))),
        least_variance=1.0,
    )
    add(
        "SemiMarkovChain.of",
        tp.SemiMarkovChain.of,
        words=("covariance",),
        components=3,
        topology="any",
        stay=4.0,
        spread=1.0,
    )
    add("SemiMarkovChain.log_durations", SEMI.log_durations, longest=9, infinite=True)


def _retrieval(book: Book) -> None:
    add = book.add
    add("gmr", tp.gmr, gmm=GMM, inputs=TIME, given=(0,), of=(1, 2), ridge=1e-6)
    add("gmr_mixture", tp.gmr_mixture, gmm=GMM, inputs=TIME, given=0, of=[1])
    add("Regression.of", tp.Regression.of, words=("of is",), gmm=GMM, given=0, of=None, ridge=0.0)
    for method in ("__call__", "mixture", "weights"):
        add(f"Regression.{method}", getattr(REGRESSION, method), inputs=TIME)
    add("Regression.at", REGRESSION.at, point=0.3)
    add("Regression", tp.Regression, **_fields(tp.Regression, REGRESSION))
    add(
        "tp_gmr",
        tp.tp_gmr,
        words=("input", "view", "A has"),
        tpgmm=TPGMM,
        frames=TIMED_FRAMES,
        inputs=TIME,
        given=(0,),
        order="regression",
        ridge=1e-6,
    )
    add(
        "tp_gmr",
        tp.tp_gmr,
        words=("input", "view", "A has"),
        tpgmm=TPGMM,
        frames=TIMED_FRAMES,
        inputs=TIME,
        order="product",
    )
    add(
        "tp_gmr",
        tp.tp_gmr,
        words=("input", "view", "A has"),
        tpgmm=TPGMM,
        frames=TIMED_FRAMES,
        inputs=TIME,
        order="held",
    )
    add(
        "fuse_frames",
        tp.fuse_frames,
        words=("noise", "frame", "mean reaches"),
        views=[SEVERAL, SEVERAL],
        frames=FRAMES,
    )
    add(
        "fit_tp_gmr",
        tp.fit_tp_gmr,
        words=("covariance", "sample", "component"),
        demonstrations=DEMONSTRATIONS,
        components=(1, 2),
        covariance="shrunk",
        order="regression",
    )
    add("TPGMR", tp.TPGMR, model=TPGMM, times=TIME, order="regression", errors={1: 0.5})
    add("TPGMR.__call__", TPGMR.__call__, words=("covariance", "noise"), frames=FRAMES)
    add(
        "fit_tp_trajectory",
        tp.fit_tp_trajectory,
        words=("covariance", "sample", "component"),
        demonstrations=DEMONSTRATIONS,
        components=2,
        shrunk=True,
    )
    add(
        "TPTrajectory",
        tp.TPTrajectory,
        model=TPTRAJECTORY.model,
        times=TIME,
        scale=1.0,
        errors={1: 0.5},
    )
    add(
        "TPTrajectory.__call__", TPTRAJECTORY.__call__, words=("covariance", "noise"), frames=FRAMES
    )
    add(
        "fit_movement",
        tp.fit_movement,
        words=("component", "sample", "covariance", "scale"),
        demonstrations=DEMONSTRATIONS,
    )
    covariances = np.tile(np.eye(6), (4, 1, 1))
    add(
        "trajectory",
        tp.trajectory,
        means=np.ones((4, 6)),
        covariances=covariances,
        dt=0.1,
        derivatives=2,
        differences="forward",
        border="free",
        scale=1.0,
    )
    add(
        "trajectory_of_states",
        tp.trajectory_of_states,
        words=("states",),
        model=STATES,
        states=np.array([0, 0, 1, 1]),
        dt=0.1,
    )
    add(
        "derivative_operator",
        tp.derivative_operator,
        words=("steps",),
        steps=5,
        dt=0.1,
        derivatives=2,
        dim=2,
        differences="forward",
    )
    add(
        "fit_trajectory_distribution",
        tp.fit_trajectory_distribution,
        words=("demonstration",),
        trajectories=np.stack(PATHS),
        modes=2,
        noise=0.1,
    )
    add(
        "fit_trajectory_distribution",
        tp.fit_trajectory_distribution,
        words=("demonstration",),
        trajectories=DEMONSTRATIONS,
        modes=2,
    )
    add(
        "TrajectoryDistribution",
        tp.TrajectoryDistribution,
        **_fields(tp.TrajectoryDistribution, DISTRIBUTION),
    )
    add("TrajectoryDistribution.sample", DISTRIBUTION.sample, rng=0, size=2, noisy=True)
    add(
        "TrajectoryDistribution.through",
        DISTRIBUTION.through,
        step=3,
        point=np.ones(2),
        covariance=0.1,
    )
    add(
        "TrajectoryDistribution.through",
        DISTRIBUTION.through,
        step=3,
        point=np.ones(2),
        covariance=np.eye(2),
    )
    add(
        "fit_tp_trajectory_distribution",
        tp.fit_tp_trajectory_distribution,
        words=("trajector",),
        demonstrations=DEMONSTRATIONS,
        modes=2,
        noise=0.1,
    )
    add("TPTrajectoryDistribution", tp.TPTrajectoryDistribution, frames=list(TPDISTRIBUTION.frames))
    add("TPTrajectoryDistribution.adapt", TPDISTRIBUTION.adapt, words=("noise",), frames=FRAMES)
    options = {"width": 0.2, "ridge": 1e-6, "weight_ridge": 1e-6, "noise": 1e-3}
    add(
        "fit_promp",
        tp.fit_promp,
        words=("demonstration", "covariance"),
        takes={"trajectories": {"ragged"}},  # movements of one and of two samples
        trajectories=PATHS,
        count=3,
        **options,
    )
    add(
        "fit_promp",
        tp.fit_promp,
        words=("demonstration", "covariance"),
        takes={"trajectories": {"ragged"}},
        trajectories=DEMONSTRATIONS,
        count=3,
    )
    add(
        "fit_tp_promp",
        tp.fit_tp_promp,
        words=("covariance",),
        demonstrations=DEMONSTRATIONS,
        count=3,
        **options,
    )
    add("ProMP", tp.ProMP, weights=PROMP.weights, count=3, width=0.2, noise=1e-3)
    add("ProMP.distribution", PROMP.distribution, steps=5)
    add("ProMP.distribution", PROMP.distribution, steps=np.array([0.1, 0.5]))
    add("TPProMP", tp.TPProMP, frames=list(TPPROMP.frames))
    add("TPProMP.adapt", TPPROMP.adapt, words=("noise",), frames=FRAMES)
    add("radial_basis", tp.radial_basis, steps=5, count=3, width=0.2)
    add("radial_basis", tp.radial_basis, steps=np.array([0.1, 0.5]), count=3)
    add("Motion", tp.Motion, position=PATHS[0], velocity=PATHS[1], acceleration=PATHS[2])
    add("Motion.of", tp.Motion.of, words=("velocity", "acceleration"), position=PATHS[0], dt=0.1)
    add(
        "Motion.of",
        tp.Motion.of,
        words=("velocity", "acceleration"),
        position=PATHS[0],
        dt=TIME,
        takes={"dt": DATES},
    )
    add("attractor_path", tp.attractor_path, motion=MOTION, stiffness=20.0, damping=9.0)
    add("decay", tp.decay, steps=5, dt=0.1, rate=1.0)
    add(
        "forcing_term",
        tp.forcing_term,
        motion=MOTION,
        goal=np.ones(2),
        s=np.linspace(1, 0.1, T),
        stiffness=20.0,
        damping=9.0,
    )
    add(
        "forced_attractor",
        tp.forced_attractor,
        goal=np.ones(2),
        forcing=PATHS[0],
        s=np.linspace(1, 0.1, T),
        stiffness=20.0,
    )


def _processes(book: Book) -> None:
    add = book.add
    add(
        "fit_gp",
        tp.fit_gp,
        words=("variance",),
        inputs=TIME,
        outputs=PATHS[0],
        kernel=KERNEL,
        center=True,
    )
    add("fit_gp", tp.fit_gp, words=("variance",), inputs=TIME, outputs=PATHS[0][:, 0])
    add("GaussianProcess", tp.GaussianProcess, **_fields(tp.GaussianProcess, PROCESS))
    for method in ("__call__", "joint_covariance", "weights"):
        add(f"GaussianProcess.{method}", getattr(PROCESS, method), queries=TIME[:4])
    add("GaussianProcess.spread", PROCESS.spread, queries=TIME[:4], ridge=0.01)
    add("SquaredExponential", tp.SquaredExponential, variance=1.0, length=0.3, noise=0.1)
    add(
        "SquaredExponential",
        tp.SquaredExponential,
        variance=np.ones(2),
        length=np.ones(2),
        noise=np.ones(2),
    )
    add("SquaredExponential.__call__", KERNEL.__call__, a=TIME[:3, None], b=TIME[:4, None])
    add("SquaredExponential.matrices", KERNEL.matrices, a=TIME[:3, None], b=TIME[:4, None])
    add(
        "fit_gp_gmm",
        tp.fit_gp_gmm,
        words=("mixture", "inputs", "variance"),
        tasks=TASKS,
        gmms=MIXTURES,
        kernel=KERNEL,
        encoding="logarithm",
        floor=1e-3,
    )
    add(
        "fit_gp_gmm",
        tp.fit_gp_gmm,
        words=("mixture", "inputs", "variance"),
        tasks=TASKS,
        gmms=MIXTURES,
        encoding="entries",
    )
    process = tp.fit_gp_gmm(TASKS, MIXTURES, KERNEL)
    add("MixtureProcess", MixtureProcess, **_fields(MixtureProcess, process))
    add("MixtureProcess.__call__", process.__call__, task=np.array([0.3]))
    add(
        "KMP",
        tp.KMP,
        inputs=TIME,
        reference=tp.Gaussian(PATHS[0], 0.1 * np.eye(2)),
        length=0.2,
        regularisation=1.0,
    )
    add("KMP.__call__", KMP.__call__, queries=TIME[:3])
    add("KMP.through", KMP.through, input=0.5, point=np.ones(2), covariance=0.01 * np.eye(2))
    add(
        "lwr",
        tp.lwr,
        words=("query",),
        inputs=TIME,
        outputs=PATHS[0],
        queries=TIME[:3],
        width=0.2,
        degree=1,
        ridge=1e-4,
    )


def _control(book: Book) -> None:
    add = book.add
    add("integrator", tp.integrator, dim=2, dt=0.1, order=2, exact=False)
    add("LinearSystem", tp.LinearSystem, A=np.eye(2), B=np.ones((2, 1)), dt=0.1)
    add("LinearSystem.step", SYSTEM.step, state=np.ones(4), control=np.ones(2))
    varying = tp.LinearSystem(np.tile(np.eye(2), (4, 1, 1)), np.ones((4, 2, 1)), 0.1)
    add("LinearSystem.step", varying.step, state=np.ones(2), control=np.ones(1), t=2)
    push = tp.Constraint("push", [-0.3, -0.3], [0.3, np.inf], control=np.eye(2))
    add(
        "Constraint",
        tp.Constraint,
        words=("constraint",),
        takes={"lower": {"one inf"}, "upper": {"one inf"}},
        infinite=True,
        name="there",
        lower=np.array([-0.5]),
        upper=np.array([0.5]),
        state=np.eye(1, 4),
        control=np.zeros((1, 2)),
    )
    add(
        "joint_range",
        tp.joint_range,
        words=("constraint",),
        takes={"lower": {"one inf"}, "upper": {"one inf"}},
        infinite=True,
        lower=-np.ones(2),
        upper=np.ones(2),
    )
    add("joint_speed", tp.joint_speed, words=("constraint",), limit=np.ones(2))
    add(
        "joint_torque",
        tp.joint_torque,
        words=("constraint",),
        limit=np.ones(2),
        mass=np.eye(2),
        bias=np.zeros(2),
    )
    add(
        "constrained_lqt",
        tp.constrained_lqt,
        words=("constraint",),
        means=MEANS,
        precisions=PRECISIONS,
        system=SYSTEM,
        effort=0.1,
        initial=np.zeros(4),
        constraints=[push, tp.joint_speed([0.2, 0.2])],
        infeasible="relax",
    )
    add("ConstrainedPlan", tp.ConstrainedPlan, states=np.ones((4, 2)), controls=np.ones((3, 1)))
    add(
        "state_references",
        tp.state_references,
        words=("coordinate", "sequence"),
        gaussians=[SEVERAL, GAUSSIAN[None]],
        sequences=[np.array([0, 1, 2]), np.array([0, 0, 0])],
        frames=FRAMES,
    )
    add("lqt", tp.lqt, means=MEANS, precisions=PRECISIONS, system=SYSTEM, effort=0.1)
    add("lqt", tp.lqt, means=MEANS, precisions=PRECISIONS, system=SYSTEM, effort=0.1 * np.eye(2))
    add(
        "lqt_batch",
        tp.lqt_batch,
        means=MEANS,
        precisions=PRECISIONS,
        system=SYSTEM,
        effort=0.1,
        initial=np.ones(4),
    )
    add(
        "lqr",
        tp.lqr,
        words=("A has", "B has", "A hold", "B hold", "A must", "B must", "B is", "A is"),
        system=SYSTEM,
        Q=np.eye(4),
        R=np.eye(2),
        discrete=True,
    )
    add(
        "lqr",
        tp.lqr,
        words=("A has", "B has", "A hold", "B hold", "A must", "B must", "B is", "A is"),
        system=(np.array([[1.0, 0.1], [0.0, 1.0]]), np.array([[0.0], [0.1]])),
        Q=np.eye(2),
        R=1.0,
        discrete=True,
    )
    add(
        "receding_horizon",
        tp.receding_horizon,
        reference=lambda t, state: (MEANS, PRECISIONS),
        system=SYSTEM,
        effort=0.1,
        initial=np.ones(4),
        steps=3,
        constraints=[push],
    )
    add(
        "Feedback", tp.Feedback, gain=np.ones((4, 2, 4)), feedforward=np.ones((4, 2)), system=SYSTEM
    )
    add("Feedback.control", FEEDBACK.control, t=2, state=np.ones(4))
    add("Feedback.rollout", FEEDBACK.rollout, initial=np.ones(4))
    add("Plan", tp.Plan, states=np.ones((4, 2)), controls=np.ones((3, 1)))
    add("Regulator", tp.Regulator, gain=np.ones((1, 2)), riccati=np.eye(2))
    add("impedance", tp.impedance, precision=np.diag([4.0, 1.0]), effort=0.1)
    add("impedance", tp.impedance, precision=np.diag([4.0, 1.0]), effort=np.diag([0.1, 0.2]))
    add("impedance_of", tp.impedance_of, feedback=FEEDBACK)
    add("impedance_of", tp.impedance_of, feedback=REGULATOR)
    add("damping_of", tp.damping_of, stiffness=20.0, ratio=1.0)
    add("spring_damper", tp.spring_damper, targets=PATHS[0], stiffness=20.0, damping=9.0, dt=0.01)
    add("PlanarChain", tp.PlanarChain, lengths=[1.0, 0.5])
    for method in ("jacobian", "orientation", "orientation_jacobian", "points", "position"):
        add(f"PlanarChain.{method}", getattr(PLANAR, method), q=Q)
    add("two_armed", tp.two_armed, lengths=[1.0, 0.5, 0.5, 0.5, 0.5])


def _geometry(book: Book) -> None:
    add = book.add
    w = np.array([[0.1, 0.2, 0.3], [0.4, -0.2, 0.1]])
    for name in ("skew", "exp", "left_jacobian", "left_jacobian_inverse"):
        (argument,) = getattr(rotation, name).__code__.co_varnames[:1]
        add(f"rotation.{name}", getattr(rotation, name), **{argument: w})
    add("rotation.angular_velocity", rotation.angular_velocity, w=w, rate=np.ones((2, 3)))
    for name in ("log", "to_quaternion", "mean"):
        add(f"rotation.{name}", getattr(rotation, name), R=ROTATIONS)
    add("rotation.tilt", rotation.tilt, R=ROTATIONS, axis=np.array([0.0, 0.0, 1.0]))
    add("rotation.from_quaternion", rotation.from_quaternion, quaternion=QUATERNIONS)
    add("rotation.continuous", rotation.continuous, quaternions=QUATERNIONS)
    J, x = np.array([[1.0, 0.5, 0.2], [0.0, 1.0, 0.7]]), np.array([0.3, 0.4])
    options = {"gain": 1.0, "damping": 0.01}
    add("projection.joint", projection.joint, n=3)
    add("projection.pseudoinverse", projection.pseudoinverse, J=J, damping=0.01)
    add("projection.nullspace", projection.nullspace, J=J, damping=0.01)
    add("projection.absolute", projection.absolute, J=J, q=Q, x=x, **options)
    add(
        "projection.relative",
        projection.relative,
        J=J,
        q=Q,
        x=x,
        A_object=np.eye(2),
        b_object=np.ones(2),
        clip=0.1,
        **options,
    )
    add("projection.nullspace_joint", projection.nullspace_joint, J=J, q=Q, **options)
    add(
        "projection.nullspace_absolute",
        projection.nullspace_absolute,
        J=J,
        q=Q,
        J_other=J[:1],
        x_other=x[:1],
        **options,
    )
    add(
        "projection.nullspace_relative",
        projection.nullspace_relative,
        J=J,
        q=Q,
        J_other=J[:1],
        x_other=x[:1],
        A_object=np.eye(1),
        b_object=np.ones(1),
        bend=0.3,
        clip=0.1,
        **options,
    )
