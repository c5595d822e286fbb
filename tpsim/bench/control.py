"""Speeds of optimal control: tracking, regulators, impedance, projection frames."""

from collections.abc import Callable

import numpy as np

from tpsim.bench.timing import processor_time
from tpsim.control import projection
from tpsim.control.impedance import impedance
from tpsim.control.lqr import lqr
from tpsim.control.lqt import lqt, lqt_batch
from tpsim.control.system import integrator


def run(quick: bool = False) -> dict:
    """Median times of the controllers, and how tracking grows with the horizon.

    Parameters
    ----------
    quick : bool
        Fewer repetitions, and a growth factor from 2000 steps instead of 10000.

    Returns
    -------
    dict
        Times in ms or us as the names say, for 3 dimensions and a double integrator; factors
        are the cost of the long horizon over that of T = 1000 (linear: the ratio of lengths).

    """
    repeat = 3 if quick else 15
    long = 2000 if quick else 10000
    short_calls, long_calls = _tracking_calls(1000), _tracking_calls(long)
    figures, factors = {}, {}
    for name, short_call in short_calls.items():
        # Both lengths in turn, so that what else the machine does weighs on both.
        times = np.array(
            [
                (processor_time(short_call, 5), processor_time(long_calls[name], 1))
                for _ in range(repeat)
            ]
        )
        figures[f"{name}_1000_ms"] = 1e3 * float(np.median(times[:, 0]))
        factors[f"{name}_factor_{long // 1000}"] = float(np.median(times[:, 1] / times[:, 0]))
    return figures | factors | _single_step(repeat)


def _tracking_calls(T: int) -> dict[str, Callable[[], object]]:
    """What is timed for a horizon of T steps."""
    system = integrator(3, 0.01)
    means, precisions = _stepwise_reference(T)
    feedback = lqt(means, precisions, system, 1e-2)
    return {
        "recursive": lambda: lqt(means, precisions, system, 1e-2),
        "batch": lambda: lqt_batch(means, precisions, system, 1e-2, means[0]),
        "rollout": lambda: feedback.rollout(means[0]),
        "covariance": feedback.covariance,
    }


def _single_step(repeat: int) -> dict:
    """Times of what a control loop calls once a step."""
    rng = np.random.default_rng(1)
    J, q, x = rng.normal(size=(6, 7)), rng.normal(size=7), rng.normal(size=6)
    precision = np.diag(rng.uniform(1.0, 100.0, 7))
    window = _stepwise_reference(50)
    system = integrator(3, 0.01)
    calls = {
        "horizon_50_us": lambda: lqt(*window, system, 1e-2),
        "regulator_us": lambda: lqr(system, window[1][0], 1e-2),
        "impedance_7_us": lambda: impedance(precision, 1e-2),
        "relative_6x7_us": lambda: projection.relative(J, q, x, np.eye(6), x),
        "nullspace_relative_6x7_us": lambda: projection.nullspace_relative(
            J, q, J, x, np.eye(6), x
        ),
    }
    return {key: 1e6 * processor_time(call, 20 * repeat) for key, call in calls.items()}


def _stepwise_reference(T: int) -> tuple[np.ndarray, np.ndarray]:
    """Means (T, 6) and precisions (T, 6, 6) of five Gaussians, each for a fifth of the time."""
    rng = np.random.default_rng(0)
    state = np.arange(T) * 5 // T
    roots = rng.normal(size=(5, 6, 6))
    return rng.normal(size=(5, 6))[state], (roots @ roots.mT + 0.1 * np.eye(6))[state]
