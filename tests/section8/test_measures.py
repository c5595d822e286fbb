import numpy as np
import pytest

from tpsim import Demonstration, Gaussian
from tpsim.errors import ArgumentError
from tpsim.section8 import measure

TIME = np.linspace(0.0, 2.0, 101)


def a_line(length=3.0):
    phase = TIME / 2
    smooth = phase**3 * (10 - 15 * phase + 6 * phase**2)
    return Demonstration(TIME, np.column_stack([length * smooth, 0 * smooth]))


def test_the_truth_is_without_error():
    figures = measure(a_line().data, a_line())
    for name in ("rms", "end", "direction"):
        assert figures[name] == pytest.approx(0, abs=1e-6)
    assert np.isnan([figures[name] for name in ("nll", "inside_50", "inside_95")]).all()


def test_minimum_jerk_has_its_known_smoothness():
    """ln(720 / 1.875^2) for any length and duration."""
    expected = np.log(720 / 1.875**2)
    assert measure(a_line().data, a_line())["jerk"] == pytest.approx(expected, abs=0.15)
    slow = Demonstration(5 * TIME, a_line(0.1).data)
    assert measure(slow.data, slow)["jerk"] == pytest.approx(expected, abs=0.15)
    shaken = a_line().data + 0.01 * np.sin(40 * TIME)[:, None]
    assert measure(shaken, a_line())["jerk"] > expected + 3


def test_shifts_and_turns_are_measured():
    truth = a_line()
    figures = measure(truth.data + np.array([0.3, 0.4]), truth)
    assert figures["rms"] == pytest.approx(0.5)
    assert figures["end"] == pytest.approx(0.5)
    assert figures["direction"] == pytest.approx(0, abs=1e-6)
    turned = truth.data @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert measure(turned, truth)["direction"] == pytest.approx(90)


def test_a_calibrated_tube_holds_what_it_says():
    rng, steps = np.random.default_rng(0), 4000
    root = rng.normal(size=(2, 2))
    path = Gaussian(np.zeros((steps, 2)), np.tile(root @ root.T, (steps, 1, 1)))
    drawn = Demonstration(np.arange(steps), path.sample(rng))
    figures = measure(path, drawn)
    assert figures["inside_50"] == pytest.approx(0.5, abs=0.03)
    assert figures["inside_95"] == pytest.approx(0.95, abs=0.015)
    assert figures["nll"] == pytest.approx(-path.log_density(drawn.data).mean())


def test_distributions_are_asked_about_what_is_demonstrated():
    truth, drawn = a_line(), Demonstration(TIME, a_line().data + 1.0)
    path = Gaussian(truth.data, np.tile(np.eye(2), (101, 1, 1)))
    figures = measure(path, truth, drawn)
    assert figures["rms"] == 0
    assert figures["nll"] == pytest.approx(1 + np.log(2 * np.pi))


@pytest.mark.parametrize(
    ("path", "words"),
    [(np.zeros((5, 2)), "asks for"), (np.full((101, 2), np.nan), "NaN"), (None, "asks for")],
)
def test_no_movement_is_refused(path, words):
    with pytest.raises(ArgumentError, match=words):
        measure(path, a_line())
