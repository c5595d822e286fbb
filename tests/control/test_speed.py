import numpy as np

from tpsim.bench.control import run


def test_tracking_is_linear_in_the_horizon():
    """Twice the steps, twice the time; the limits leave room for a busy machine."""
    figures = run(quick=True)
    assert all(np.isfinite(value) and value > 0 for value in figures.values())
    for name in ("recursive", "batch", "rollout", "covariance"):
        assert figures[f"{name}_factor_2"] < 3.5
    assert figures["recursive_1000_ms"] < 100
    assert figures["batch_1000_ms"] < 60
