"""demo_TPLQT01: LQT of a stepwise reference seen in two coordinate systems (TP-LQT, Eq. 38).

Look for: the path leaves the first U and enters the second along their open sides, in
situations that were not taught; tracking in both frames at once is tracking their product.
"""

import numpy as np

from tpsim import fit_tp_gmm, integrator, lqt_batch
from tpsim.examples import u_demonstrations, u_frames

COMPONENTS, EFFORT = 4, 1e-4


def solve(situations=4):
    """Demonstrations, and for new situations the frames with their plans."""
    taught = [demonstration.with_derivatives(1) for demonstration in u_demonstrations()]
    model = fit_tp_gmm(taught, COMPONENTS, start="time")
    states = model.responsibilities(taught[:1]).argmax(axis=1)
    system, rng = integrator(2, taught[0].time[1]), np.random.default_rng(1)
    results = []
    for _ in range(situations):
        frames = u_frames(rng)
        start = np.r_[frames[0].b, 0.0, 0.0]
        reference = model.adapt([f.with_derivatives(1) for f in frames]).gaussians[states]
        plan = lqt_batch(reference.mean, reference.precision, system, EFFORT, start)
        results.append((frames, plan))
    return taught, results


def main() -> dict:
    _, results = solve()
    ends = [np.linalg.norm(plan.states[-1, :2] - frames[1].b) for frames, plan in results]
    entries = [frames[1].to_local(plan.states[-25, :2]) for frames, plan in results]
    return {
        "largest_end_error": float(max(ends)),
        "largest_sideways_at_entry": float(max(abs(entry[0]) for entry in entries)),
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_frames

    taught, results = solve()
    draw_demonstrations(plt.gca(), taught)
    for frames, plan in results:
        plt.plot(*plan.states[:, :2].T, "k")
        draw_frames(plt.gca(), frames)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
