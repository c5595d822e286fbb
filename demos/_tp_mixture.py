"""What the four rows of task-parameterized mixtures share: two objects, three components."""

from functools import cache

import numpy as np

from tpsim import Frame, fit_tp_gmm, plot
from tpsim.examples import EXIT, u_demonstrations, u_frames
from tpsim.gallery import Bounded, Draw, Main, within
from tpsim.learning.subspace import Structure

NAMES = ("first object", "second object")
ITSELF = Frame(np.eye(2), np.zeros(2))


def tp_mixture(covariance: str | Structure, parameters: int) -> tuple[Main, Draw]:
    """Functions ``main`` and ``draw`` of a row whose model has the given number of parameters."""

    @cache
    def learn():
        demonstrations = u_demonstrations(8)
        model = fit_tp_gmm(demonstrations, 3, covariance=covariance, start="time")
        frames = u_frames(np.random.default_rng(3), spread=2.0)
        return demonstrations, model, frames, model.adapt(frames)

    def main() -> dict[str, Bounded]:
        demonstrations, model, frames, adapted = learn()
        full = fit_tp_gmm(demonstrations, 3, start="time")
        first, *_, last = adapted.gaussians.mean
        inside = "the component lies within the walls of its object, wherever that is"
        gains = np.diff(model.history)
        return {
            "free_parameters": within(
                model.free_parameters, parameters, parameters, "counted by hand: K = 3, P = D = 2"
            ),
            "log_likelihood_lost": within(
                full.history[-1] - model.history[-1],
                -1e-6,
                0.02,
                "in the plane, one direction and a noise are nearly a full covariance",
            ),
            "smallest_gain_of_an_iteration": within(
                gains.min(), -1e-9, np.inf, "EM never lowers the likelihood"
            ),
            "first_component_to_object_m": within(
                np.linalg.norm(first - frames[0].b), 0, EXIT, inside
            ),
            "last_component_to_object_m": within(
                np.linalg.norm(last - frames[1].b), 0, EXIT, inside
            ),
        }

    def draw(figure) -> None:
        demonstrations, model, frames, adapted = learn()
        axes = plot.panels(figure, 1, 4, size=(2.7, 2.4))
        common, *local, new = axes
        plot.demonstrations(common, demonstrations, label="demonstrations")
        for d in demonstrations:
            plot.frames(common, d.frames, size=0.6, labels=NAMES)
        for j, (axis, seen) in enumerate(zip(local, model.frames, strict=True)):
            plot.demonstrations(axis, [d.observations[j] for d in demonstrations])
            plot.ellipses(axis, seen, label="components")
            plot.frames(axis, [ITSELF], [plot.PALETTE[2 + j]])
        plot.ellipses(new, adapted.gaussians, plot.PALETTE[1], label="adapted components")
        plot.frames(new, frames)
        titles = ("demonstrations", "seen from the first", "seen from the second", "new situation")
        for axis, title in zip(axes, titles, strict=True):
            plot.title(axis, title)
            axis.set_xlabel("x [m]")
        common.set_ylabel("y [m]")
        plot.legend(figure)

    return main, draw
