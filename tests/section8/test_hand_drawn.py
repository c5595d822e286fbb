import numpy as np

from tpsim import fit_movement
from tpsim.section8.hand_drawn import hand_drawn
from tpsim.section8.left_out import leave_one_out
from tpsim.section8.methods import METHODS


def rms(trials):
    return np.sqrt(np.mean([trial.figures[:, 0, 0] ** 2 for trial in trials], axis=0))


def test_sets_are_of_the_shape_of_the_tutorials_data():
    taught = hand_drawn(4, 50, seed=3)
    assert [d.data.shape for d in taught] == [(50, 2)] * 4
    for demonstration in taught:
        for frame, sign in zip(demonstration.frames, (1, -1), strict=True):
            np.testing.assert_allclose(frame.A @ frame.A.T, 0.1 * np.eye(2), atol=1e-12)
            assert np.sign(np.linalg.det(frame.A)) == sign
        assert (np.linalg.norm(np.diff(demonstration.data, axis=0), axis=1) > 0).all()
    again = hand_drawn(2, 50, seed=3)
    np.testing.assert_array_equal(again[1].data, taught[1].data)


def test_the_default_predicts_what_was_left_out_better_than_any_usual_structure():
    names = ("TP-GMM", "TP-GMR", "TP-GMR full", "TP-GMR diagonal", "TP-GMR product")
    methods = {name: METHODS[name] for name in names}
    ours, shrunk, full, diagonal, product = rms(leave_one_out(hand_drawn(4, 40, 3), methods))
    assert ours < shrunk < min(full, diagonal, product)
    assert ours < 0.24


def test_the_movement_ends_where_a_hand_would():
    taught = hand_drawn(5, 50, seed=1)
    path = fit_movement(taught[:4])(taught[4].frames)
    assert np.linalg.norm(path.mean[-1] - taught[4].data[-1]) < 0.15
