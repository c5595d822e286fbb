"""demo_trajHSMM01: a movement from an HSMM with dynamic features (trajectory-HSMM).

Look for: the states last as long as in the demonstrations, and the stepwise means become one
smooth letter (Section 5.2); every sample of the states is another way to write it.
"""

import numpy as np

from tpsim import fit_hsmm, trajectory_of_states
from tpsim.examples import letters

STATES, SAMPLES = 6, 10


def write():
    """Learn [x, dx, ddx] with durations, then retrieve the likeliest and some random letters."""
    demonstrations = letters("S", count=6, samples=100)
    dt = float(demonstrations[0].time[1])
    model = fit_hsmm([d.with_derivatives(2).data for d in demonstrations], STATES, start="time")
    rng = np.random.default_rng(0)
    states = [model.state_sequence(100), *(model.sample_states(100, rng) for _ in range(SAMPLES))]
    paths = [trajectory_of_states(model.emissions, q, dt) for q in states]
    return demonstrations, model, states, paths


def main() -> dict:
    demonstrations, model, states, paths = write()
    mean = np.mean([d.data for d in demonstrations], axis=0)
    distances = [np.linalg.norm(path.mean - mean, axis=1).max() for path in paths]
    return {
        "mean_durations_in_steps": model.chain.durations.mean[:, 0].tolist(),
        "changes_of_state_at": (np.flatnonzero(np.diff(states[0])) + 1).tolist(),
        "distance_from_the_mean_demonstration": float(distances[0]),
        "largest_distance_of_a_sampled_movement": float(max(distances[1:])),
        "widest_spread": float(np.sqrt(np.linalg.eigvalsh(paths[0].covariance).max())),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_path

    demonstrations, model, _, paths = write()
    _, (plane, probability) = plt.subplots(1, 2)
    draw_demonstrations(plane, demonstrations)
    for path in paths[1:]:
        plane.plot(*path.mean.T, lw=0.6)
    draw_path(plane, paths[0])
    probability.plot(model.state_probabilities(100))
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
