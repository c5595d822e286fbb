"""demo_trajHSMM01: a movement from an HSMM with dynamic features (trajectory-HSMM).

Look for: the states last as long as in the demonstrations, and the stepwise means become one
smooth letter (Section 5.2); every sample of the states is another way to write it.
"""

from functools import cache

import numpy as np

from tpsim import fit_hsmm, plot, trajectory_of_states
from tpsim.examples import letters
from tpsim.gallery import present, within

STATES, SAMPLES, T = 6, 10, 100


@cache
def write():
    """Learn [x, dx, ddx] with durations, then retrieve the likeliest and some random letters."""
    taught = letters("S", count=6, samples=T)
    dt = float(taught[0].time[1])
    model = fit_hsmm([d.with_derivatives(2).data for d in taught], STATES, start="time")
    rng = np.random.default_rng(0)
    states = [model.state_sequence(T), *(model.sample_states(T, rng) for _ in range(SAMPLES))]
    return taught, model, [trajectory_of_states(model.emissions, q, dt) for q in states]


def main():
    taught, model, paths = write()
    mean = np.mean([d.data for d in taught], axis=0)
    likeliest, *sampled = (np.linalg.norm(path.mean - mean, axis=1).max() for path in paths)
    return {
        "durations_sum_steps": within(
            model.chain.durations.mean.sum(), 0.98 * T, 1.02 * T, "durations add up to the movement"
        ),
        "likeliest_from_mean_letter_m": within(
            likeliest, 0, 0.1, "within the spread of the demonstrations"
        ),
        "sampled_from_mean_letter_m": within(
            max(sampled), 0.1, 1.0, "other durations, another timing; still the letter, 2 m high"
        ),
    }


def draw(figure):
    taught, model, paths = write()
    plane, curve = plot.panels(figure, 1, 2, size=(3.4, 3.4), kind=["plane", "curve"])
    plot.demonstrations(plane, taught, label="demonstrations")
    for path in paths[1:]:
        plane.plot(*path.mean.T, color=plot.PALETTE[0], lw=0.8, label="sampled")
    plot.tube(plane, paths[0], label="likeliest")
    plane.set(xlabel="x [m]", ylabel="y [m]")
    for k, probability in enumerate(model.state_probabilities(T).T):
        curve.fill_between(taught[0].time, probability, alpha=0.4, color=plot.PALETTE[k])
        middle = taught[0].time[probability.argmax()]
        curve.text(middle, 1.03, str(k + 1), ha="center", color=plot.INK, fontsize=8)
    curve.set(xlabel="time [s]", ylabel="probability of every state", ylim=(0, 1.1))
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
