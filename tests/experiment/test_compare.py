import numpy as np
import pytest

from tpsim import Gaussian
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstration, u_demonstrations
from tpsim.experiment.compare import compare, figure, measure, retrieve_all, situations
from tpsim.experiment.methods import METHODS
from tpsim.study.canvas import to_png

SEEN_FROM_FRAMES = ("TP-GMM", "TP-MFA", "TP-trajGMM", "TP-GP", "TP-LWR")


@pytest.fixture(scope="module")
def all_methods():
    demonstrations, tasks = u_demonstrations(5, samples=60), situations()
    return demonstrations, tasks, retrieve_all(demonstrations, tasks)


def test_frames_carry_the_movement_where_others_lose_it(all_methods):
    """What Figs 12 to 14 show: from near to far, only models of frames still meet the goal."""
    _, tasks, results = all_methods
    assert list(results) == list(METHODS)
    ends = {
        name: [measure(p, f)["end_error"] for p, f in zip(r["paths"], tasks, strict=True)]
        for name, r in results.items()
    }
    assert max(max(ends[name]) for name in SEEN_FROM_FRAMES) < 0.15
    for name in ("GPR", "GPR-GMM"):
        assert ends[name][-1] > 0.25
        assert ends[name][-1] > 2 * ends[name][0]


def test_every_path_is_a_trajectory_of_gaussians(all_methods):
    _, _, results = all_methods
    for result in results.values():
        for path in result["paths"]:
            assert path.mean.shape == (60, 2)
            assert np.isfinite(path.mean).all()
            assert np.linalg.eigvalsh(path.covariance).min() > -1e-12


def test_figure_has_a_panel_for_every_path(all_methods):
    drawing = figure(*all_methods)
    assert len(drawing.axes) == len(METHODS) * 4
    assert to_png(drawing, dpi=20).startswith(b"\x89PNG")


def test_the_teachers_own_path_has_no_error():
    for frames in situations():
        data = u_demonstration(frames).data
        figures = measure(Gaussian(data, np.tile(np.eye(2), (len(data), 1, 1))), frames)
        assert figures["entry_angle"] < 20
        for name in ("start_error", "end_error", "end_x", "end_y", "path_error"):
            assert abs(figures[name]) < 1e-9


def test_situations_go_ever_farther():
    moved = [np.linalg.norm(frames[1].b - [1.2, 0.4]) for frames in situations()]
    np.testing.assert_allclose(moved / moved[0], [1, 2, 4, 6])


def test_same_seed_same_rows():
    numbers = [
        [{k: v for k, v in row.items() if not k.endswith("_ms")} for row in result["rows"]]
        for result in (compare(3, seed=5, names=["TP-GMM"]) for _ in range(2))
    ]
    assert numbers[0] == numbers[1]
    assert [row["situation"] for row in numbers[0]] == [1, 2, 3, 4]


def test_bad_arguments():
    with pytest.raises(ArgumentError, match="TP-LWR"):
        compare(names=["TP-GNN"])
    with pytest.raises(ArgumentError, match="at least 2"):
        compare(1)
