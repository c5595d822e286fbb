"""The bench of simulation measures what it names."""

from tpsim.bench import simulation
from tpsim.film import rendering


def test_figures_of_a_task(monkeypatch):
    monkeypatch.setattr(rendering, "backend", lambda: None)
    figures = simulation.run(quick=True, names=["pointing"])
    assert set(figures) == {
        "pointing_physics_factor",
        "pointing_realtime_factor",
        "pointing_environment_steps_per_s",
        "pointing_tank_percent",
    }
    # Control costs more than physics alone, and physics is faster than real time.
    assert figures["pointing_physics_factor"] > figures["pointing_realtime_factor"] > 1
    assert figures["pointing_environment_steps_per_s"] > 100
    # Books cost far less than a step; once and on a busy machine nothing finer can be said.
    assert -30 < figures["pointing_tank_percent"] < 50
