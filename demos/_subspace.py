"""What the three subspace rows share: two letters drawn at once, beside full covariances."""

from functools import cache

import numpy as np

from tpsim import GMM, fit_gmm, plot
from tpsim.examples import letters
from tpsim.gallery import Bounded, Draw, Main, within
from tpsim.learning.subspace import Structure

COMPONENTS, LETTERS = 4, ("letter C", "letter S")


def subspaces(name: str, structure: Structure, parameters: int) -> tuple[Main, Draw]:
    """Functions ``main`` and ``draw`` of a row whose model has the given number of parameters."""

    @cache
    def learn() -> tuple[list[np.ndarray], dict[str, GMM]]:
        both = zip(letters("C", count=5), letters("S", count=5), strict=True)
        data = [np.hstack([c.data, s.data]) for c, s in both]
        kinds: dict[str, str | Structure] = {name: structure, "full": "full"}
        return data, {
            kind: fit_gmm(data, COMPONENTS, covariance=covariance, start="time")
            for kind, covariance in kinds.items()
        }

    def main() -> dict[str, Bounded]:
        _, models = learn()
        small, full = models[name], models["full"]
        price = full.history[-1] - small.history[-1]
        return {
            "free_parameters": within(
                small.free_parameters, parameters, parameters, "counted by hand: K = 4, D = 4"
            ),
            "free_parameters_full": within(full.free_parameters, 59, 59, "4 (4 + 10) + 3"),
            "log_likelihood_lost": within(
                price, 0, 1.5, "fewer parameters cost likelihood; nats per sample"
            ),
            "smallest_gain_of_an_iteration": within(
                np.diff(small.history).min(), -1e-9, np.inf, "EM never lowers the likelihood"
            ),
        }

    def draw(figure) -> None:
        data, models = learn()
        axes = plot.panels(figure, 2, 2, size=(2.6, 2.3))
        for i, axis in enumerate(axes):
            kind, dims = list(models)[i // 2], [[0, 1], [2, 3]][i % 2]
            plot.demonstrations(axis, [x[:, dims] for x in data], label="demonstrations")
            colour = plot.PALETTE[i // 2]
            gaussians = models[kind].gaussians.marginal(dims)
            plot.ellipses(axis, gaussians, colour, label=f"{kind} covariances")
            plot.title(axis, LETTERS[i % 2] if i < 2 else "")
            axis.set(xticks=[], yticks=[])
            if i % 2 == 0:
                axis.set_ylabel(f"{kind}, {models[kind].free_parameters} parameters")
        plot.same_view(axes)
        plot.legend(figure)

    return main, draw
