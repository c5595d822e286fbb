"""What the tracking rows share: a letter, its mixture of position and velocity, the states."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tpsim import GMM, Demonstration, Gaussian, LinearSystem, fit_gmm, integrator, plot
from tpsim.examples import letters
from tpsim.gallery import Bounded, within


@dataclass(frozen=True)
class Reference:
    """A letter as a stepwise reference: each state of a mixture, for as long as it lasts.

    The mixture is over position and velocity, or over position alone without ``derivatives``.
    """

    letter: str
    components: int
    derivatives: int = 1
    ridge: float | None = None

    @cached_property
    def taught(self) -> list[Demonstration]:
        """Demonstrations [x, dx], or [x]."""
        return [d.with_derivatives(self.derivatives) for d in letters(self.letter)]

    @cached_property
    def gmm(self) -> GMM:
        """Mixture of all samples."""
        data = [d.data for d in self.taught]
        return fit_gmm(data, self.components, start="time", ridge=self.ridge)

    @cached_property
    def states(self) -> np.ndarray:
        """Likeliest state of the first demonstration at every step (T,)."""
        return self.gmm.responsibilities(self.taught[0].data).argmax(axis=1)

    @property
    def steps(self) -> Gaussian:
        """Gaussian of every step (T,)."""
        return self.gmm.gaussians[self.states]

    @property
    def system(self) -> LinearSystem:
        """Double integrator with the time step of the demonstrations."""
        return integrator(2, self.taught[0].time[1])

    @property
    def start(self) -> np.ndarray:
        """Start of the first demonstration, at rest (4,)."""
        return np.r_[self.taught[0].data[0, :2], 0.0, 0.0]

    def rms(self, states: np.ndarray, greatest: float, reason: str) -> Bounded:
        """Root mean square distance of a path from the first demonstration [m]."""
        gap = np.linalg.norm(states[:, :2] - self.taught[0].data[:, :2], axis=1)
        return within(np.sqrt(np.mean(gap**2)), 0, greatest, reason)

    def draw(self, axis, paths: Mapping[str, np.ndarray]) -> None:
        """Draw letters, states, and paths (T, 2 or more) by name."""
        plot.demonstrations(axis, self.taught, label="demonstrations")
        gaussians = self.gmm.gaussians.marginal([0, 1])
        plot.ellipses(axis, gaussians, plot.INK, fill=0.1, label="states")
        for (name, path), colour in zip(paths.items(), plot.PALETTE, strict=False):
            axis.plot(*path[:, :2].T, color=colour, lw=1.8, label=name, zorder=3)
        axis.set(xlabel="x [m]", ylabel="y [m]")
