"""demo_TPMFA01: a task-parameterized mixture of factor analysers (Section 4.2).

Look for: the ellipses of demo_TPGMM01 from one direction per component and frame (Eq. 11).
"""

import numpy as np

from tpsim import MFA, fit_tp_gmm
from tpsim.examples import EXIT, u_demonstrations, u_frames


def learn():
    """Three components seen from both objects, then a situation that was never shown."""
    demonstrations = u_demonstrations(5)
    model = fit_tp_gmm(demonstrations, 3, covariance=MFA(1), start="time")
    frames = u_frames(np.random.default_rng(1), spread=2.0)
    return demonstrations, model, frames, model.adapt(frames)


def main() -> dict:
    _, model, frames, adapted = learn()
    mean = adapted.gaussians.mean
    return {
        "free_parameters": model.free_parameters,
        "iterations": len(model.history) - 1,
        "log_likelihood_of_a_sample": float(model.history[-1]),
        "first_component_to_first_object": float(np.linalg.norm(mean[0] - frames[0].b)),
        "last_component_to_second_object": float(np.linalg.norm(mean[-1] - frames[1].b)),
        "depth_of_the_objects": EXIT,
    }


def draw() -> None:
    import matplotlib.pyplot as plt

    from tpsim.experiment.plane import draw_demonstrations, draw_ellipses, draw_frames

    demonstrations, model, frames, adapted = learn()
    _, axes = plt.subplots(1, 4)
    draw_demonstrations(axes[0], demonstrations)
    for j, (axis, seen) in enumerate(zip(axes[1:3], model.frames, strict=True)):
        for d in demonstrations:
            axis.plot(*d.observations[j].T, "k", lw=0.6, alpha=0.3)
        draw_ellipses(axis, seen)
    draw_ellipses(axes[3], adapted.gaussians)
    draw_frames(axes[3], frames)
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
