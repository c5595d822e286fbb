import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.study.measure import Measure, Result, rms
from tpsim.study.metrics import displacement, mean_force, push_interval, work
from tpsim.world.trial import Trial


@pytest.mark.parametrize(
    ("value", "limit", "at_least", "passed"),
    [
        (4.9, 5, False, True),
        (5.0, 5, False, True),
        (5.1, 5, False, False),
        (39, 40, True, False),
        (41, 40, True, True),
        (np.nan, 5, False, False),
        (None, 5, True, False),
        (3.0, None, False, None),
    ],
)
def test_a_measure_knows_whether_it_keeps_its_limit(value, limit, at_least, passed):
    assert Result("tilt", "Tilt", value, "deg", limit, at_least).passed is passed


def test_what_no_trial_was_asked_for_is_not_missed():
    measure = Measure("tilt", of=lambda record: None, label="pushed", limit=5.0)
    assert measure.result(None).passed is False
    assert measure.result(None, asked=False).passed is None


def test_rms_of_a_sine_is_its_amplitude_over_root_two():
    phase = np.arange(1000) * 2 * np.pi / 1000
    assert rms(3 * np.sin(phase)) == pytest.approx(3 / np.sqrt(2))
    assert rms(np.array([[3.0, 4.0], [0.0, 0.0]])) == pytest.approx(2.5)


def test_work_against_a_spring_is_half_k_x_squared():
    x = np.linspace(0, 0.1, 400)[:, None] * [1.0, 0, 0]
    wrench = np.concatenate([300 * x, np.zeros((400, 3))], axis=1)
    assert work(wrench, x) == pytest.approx(0.5 * 300 * 0.1**2)
    assert work(wrench, x[::-1]) == pytest.approx(-0.5 * 300 * 0.1**2)


def test_a_push_is_found_in_its_recording():
    time = np.arange(100) / 100
    wrench = np.zeros((100, 6))
    assert push_interval(Trial({"time": time, "push_wrench": wrench})) is None
    assert push_interval(Trial({"time": time})) is None
    assert mean_force(wrench) == 0
    wrench[20:40, :2] = [3, -4]
    assert push_interval(Trial({"time": time, "push_wrench": wrench})) == (0.2, 0.39)
    assert mean_force(wrench) == pytest.approx(5)


def test_displacement_is_measured_against_the_unpushed_twin():
    time = np.arange(100) / 100
    rest = np.random.default_rng(0).normal(size=(100, 3))
    twin = Trial({"time": time, "hand": rest})
    pushed = Trial({"time": time[:60], "hand": rest[:60] + np.array([0.03, 0, 0.04])})
    np.testing.assert_allclose(displacement(pushed, twin, "hand"), np.full(60, 0.05))
    with pytest.raises(ArgumentError, match="different clocks"):
        displacement(Trial({"time": time + 0.5, "hand": rest}), twin, "hand")
