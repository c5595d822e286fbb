"""Which model: the one that errs least in situations that it was not taught in."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.subspace import MFA, Structure
from tpsim.learning.tp_gmm import TPGMM, fit_tp_gmm
from tpsim.retrieval.fusion import fuse_frames
from tpsim.retrieval.gmr import Regression

COMPONENTS = (3, 5, 8)
STRUCTURES: tuple[str | Structure, ...] = ("full", MFA(1))
"""Few demonstrations determine few correlations: one factor, which time and movement share, often
errs less. Diagonal covariances know no slope over time: what they retrieve climbs in steps."""

FOLDS = 6


@dataclass(frozen=True)
class Choice:
    """Number of components and structure of covariances."""

    components: int
    covariance: str | Structure

    def fit(self, movements: Sequence[Demonstration]) -> TPGMM:
        """Learn from movements, with time in front of their data (Eq. 20)."""
        timed = [movement.with_time() for movement in movements]
        return fit_tp_gmm(timed, self.components, covariance=self.covariance, start="time")


def retrieve(model: TPGMM, movement: Demonstration) -> Gaussian:
    """Movement in a situation: regression on time in every frame (Eqs 13-19), then their product.

    Mean (T, D) and covariance (T, D, D), at the times of ``movement``. The other order, first the
    product of the components (Eqs 5-6), lets the frames pull components along time.
    """
    time = movement.time - movement.time[0]
    views = [Regression.of(GMM(model.priors, view))(time) for view in model.frames]
    return fuse_frames(views, movement.frames)


Unseen = list[tuple[Demonstration, Gaussian]]
"""Movements, each with what a model retrieves there that has not seen it."""


def choose(movements: Sequence[Demonstration], components: int | None) -> tuple[Choice, Unseen]:
    """Choose by the error in situations left out of the learning, every column by its spread.

    With fewer than three movements there is nothing to choose by: five full components, or as
    many as asked for.

    Raises
    ------
    ArgumentError
        No candidate can be fitted.
    """
    if len(movements) < 3:
        return Choice(5 if components is None else components, "full"), []
    numbers = COMPONENTS if components is None else (components,)
    spread = np.std(np.vstack([m.data for m in movements]), axis=0)
    scale = np.where(spread > 1e-9 * spread.max(), spread, np.inf)
    best: tuple[float, Choice, Unseen] | None = None
    refused: ArgumentError | None = None
    for choice in (Choice(K, structure) for structure in STRUCTURES for K in numbers):
        try:
            unseen = left_out(movements, choice)
        except ArgumentError as error:  # more components than samples, say
            refused = error
            continue
        score = float(np.mean([np.mean(((m.data - r.mean) / scale) ** 2) for m, r in unseen]))
        if best is None or score < best[0]:
            best = score, choice, unseen
    if best is None:
        assert refused is not None
        raise refused
    return best[1:]


def left_out(movements: Sequence[Demonstration], choice: Choice) -> Unseen:
    """Retrieve every movement by a model that has not seen it."""
    folds = min(len(movements), FOLDS)
    unseen = []
    for fold in range(folds):
        model = choice.fit([m for i, m in enumerate(movements) if i % folds != fold])
        unseen += [(m, retrieve(model, m)) for m in movements[fold::folds]]
    return unseen
