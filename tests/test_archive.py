"""Every model can be saved, and one reader brings each back as what it was."""

import numpy as np
import pytest

import tpsim
from tpsim import GMM, TPGMM, Demonstration, Frame, Gaussian, Motion
from tpsim.archive import SCHEMA
from tpsim.errors import RecordingError
from tpsim.retrieval.gmr import Regression

RNG = np.random.default_rng(0)
T = np.linspace(0, 1, 25)
PATHS = [np.cumsum(RNG.normal(size=(25, 2)), 0) for _ in range(4)]
FRAME = Frame(np.eye(2), np.zeros(2))
DEMONSTRATIONS = [Demonstration(T, x, [FRAME, FRAME], name=str(n)) for n, x in enumerate(PATHS)]
SYSTEM = tpsim.integrator(1, 0.1)
ROUGH = {"max_iterations": 2}

VALUES = {
    "Demonstration": lambda: DEMONSTRATIONS[0],
    "Frame": lambda: FRAME,
    "Gaussian": lambda: Gaussian(np.zeros((3, 2)), np.eye(2)),
    "GMM": lambda: tpsim.fit_gmm(PATHS, 2, covariance=tpsim.MFA(1), **ROUGH),
    "TPGMM": lambda: tpsim.fit_tp_gmm(DEMONSTRATIONS, 2, **ROUGH),
    "HMM": lambda: tpsim.fit_hmm(DEMONSTRATIONS, 2, **ROUGH),
    "HSMM": lambda: tpsim.fit_hsmm(PATHS, 2, **ROUGH),
    "PGMM": lambda: tpsim.fit_pgmm(PATHS, [[0.0], [1.0], [2.0], [3.0]], 2, **ROUGH),
    "ProMP": lambda: tpsim.fit_promp(PATHS, 4),
    "TPProMP": lambda: tpsim.fit_tp_promp(DEMONSTRATIONS, 4, noise=1e-3),
    "TrajectoryDistribution": lambda: tpsim.fit_trajectory_distribution(PATHS, 2),
    "TPTrajectoryDistribution": lambda: tpsim.fit_tp_trajectory_distribution(DEMONSTRATIONS, 2),
    "GaussianProcess": lambda: tpsim.fit_gp(T, PATHS[0]),
    "MixtureProcess": lambda: tpsim.fit_gp_gmm(
        [[0.0], [1.0]], [tpsim.fit_gmm(x, 2, **ROUGH) for x in PATHS[:2]]
    ),
    "Motion": lambda: Motion.of(PATHS[0], T),
    "Regression": lambda: Regression.of(tpsim.fit_gmm(PATHS, 2, **ROUGH)),
    "LinearSystem": lambda: SYSTEM,
    "Feedback": lambda: tpsim.lqt(np.zeros((4, 2)), np.tile(np.eye(2), (4, 1, 1)), SYSTEM, 1.0),
    "Regulator": lambda: tpsim.lqr(SYSTEM, np.eye(2), 1.0),
    "PlanarChain": lambda: tpsim.PlanarChain([1.0, 0.5]),
}


def leaves(value, path=""):
    if hasattr(value, "__dataclass_fields__"):
        yield path, type(value).__name__
        for name in value.__dataclass_fields__:
            yield from leaves(getattr(value, name), f"{path}.{name}")
    elif isinstance(value, tuple | list):
        for i, part in enumerate(value):
            yield from leaves(part, f"{path}.{i}")
    else:
        yield path, value


@pytest.mark.parametrize("kind", VALUES)
def test_one_reader_returns_the_right_class_and_the_same_bits(kind, tmp_path):
    value = VALUES[kind]()
    again = tpsim.load(value.save(tmp_path / "value.npz"))
    assert type(again) is type(value)
    assert type(type(value).load(tmp_path / "value.npz")) is type(value)
    assert type(value).__name__ == kind
    found, expected = dict(leaves(again)), dict(leaves(value))
    assert found.keys() == expected.keys()
    for path, one in expected.items():
        np.testing.assert_array_equal(found[path], one, err_msg=path)
        assert isinstance(one, np.ndarray) or type(found[path]) is type(one), path


def test_a_loaded_model_answers_as_before(tmp_path):
    model = VALUES["HSMM"]()
    again = tpsim.load(model.save(tmp_path / "model.npz"))
    assert again.log_likelihood(PATHS[0]) == model.log_likelihood(PATHS[0])


def test_another_class_is_refused(tmp_path):
    path = VALUES["GMM"]().save(tmp_path / "model.npz")
    with pytest.raises(RecordingError, match="is a GMM; a TPGMM was asked for"):
        TPGMM.load(path)


def changed(path, **arrays):
    with np.load(path) as archive:
        kept = {name: archive[name] for name in archive.files}
    np.savez(path, **{name: a for name, a in (kept | arrays).items() if a is not None})


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"schema": np.array(SCHEMA + 1)}, "schema 2.*update"),
        ({"schema": None}, "no value or model"),
        ({"kind": np.array("Path")}, "damaged.*not known"),
        ({"priors": None}, "damaged"),
        ({"priors": np.array([0.9, 0.9])}, "damaged.*sum to 1"),
        ({"gaussians.covariance": -np.ones((2, 2, 2))}, "damaged.*negative"),
        ({"gaussians.kind": np.array("None")}, "damaged"),
        ({"kind": np.array("Full")}, "does not stand alone"),
    ],
)
def test_a_damaged_archive_ends_in_one_line(arrays, words, tmp_path):
    path = VALUES["GMM"]().save(tmp_path / "model.npz")
    changed(path, **arrays)
    with pytest.raises(RecordingError, match=words):
        GMM.load(path)
