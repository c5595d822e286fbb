"""Eigenframes, eigenposes and eigentrajectories (Section 9): demonstrations as one tensor."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from tpsim.border import Count, NotNegative, Range, Share, border, checked
from tpsim.checks import LARGEST
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.learning.multilinear import Tucker, tucker

Samples = Annotated[int, Range(least=2, most=1e5)]
"""Of a movement, evenly over its time."""

ROUNDS = 50
"""In which the axes of the frames are brought into agreement, at most."""


@dataclass(frozen=True, eq=False)
class Eigenframes:
    """What several frames saw of several demonstrations, by its directions along every mode.

    The tensor X (T, P, d, N) holds progress, frames, dimensions and demonstrations. Its
    deviations from the mean demonstration are decomposed as Tucker has it, after every frame's
    axes were turned once and for all into agreement with those of the others.

    Parameters
    ----------
    mean : (T, P, d)
        Mean demonstration, as each frame sees it.
    axes : (P, d, d)
        Orthonormal: by which the views are turned.
    decomposition : Tucker
        Of the turned deviations (T, P, d, N).
    spread : float
        Root mean square of the deviations, in the unit of the data.
    """

    mean: np.ndarray
    axes: np.ndarray
    decomposition: Tucker
    spread: NotNegative

    def __post_init__(self) -> None:
        checked(self)
        lengths = tuple(len(factor) for factor in self.decomposition.factors)
        if (
            self.mean.ndim != 3
            or lengths[:-1] != self.mean.shape
            or self.axes.shape != (lengths[1], lengths[2], lengths[2])
        ):
            raise ArgumentError(
                f"mean has shape {self.mean.shape}, axes {self.axes.shape}, and the decomposition "
                f"is of a tensor {lengths}; give (T, P, d), (P, d, d) and (T, P, d, N)"
            )

    @property
    def trajectories(self) -> np.ndarray:
        """Eigentrajectories (T, r): courses over progress of which all variation is mixed."""
        return self.decomposition.factors[0]

    @property
    def frames(self) -> np.ndarray:
        """Eigenframes (P, r): mixtures of frames that vary as one."""
        return self.decomposition.factors[1]

    @property
    def poses(self) -> np.ndarray:
        """Eigenposes (d, r): directions in which the frames see variation."""
        return self.decomposition.factors[2]

    @property
    def scores(self) -> np.ndarray:
        """What tells the demonstrations apart, (N, r)."""
        return self.decomposition.factors[3]

    @property
    def error(self) -> float:
        """Root mean square of what is left out, in the unit of the data."""
        return self.spread * float(np.sqrt(max(1 - self.decomposition.share, 0.0)))

    @property
    def compression(self) -> float:
        """How many times fewer numbers the decomposition takes than the deviations."""
        lengths = [len(factor) for factor in self.decomposition.factors]
        return float(np.prod(lengths)) / self.decomposition.numbers

    @property
    def full(self) -> np.ndarray:
        """The views (T, P, d, N) that it stands for."""
        turned = np.einsum("pab,tpan->tpbn", self.axes, self.decomposition.full)
        return self.mean[..., None] + turned

    def __str__(self) -> str:
        """Table with one line per mode."""
        lines = ["mode              kept   of   share that the first directions hold"]
        names = "eigentrajectories", "eigenframes", "eigenposes", "demonstrations"
        parts = zip(names, self.decomposition.factors, self.decomposition.values, strict=True)
        for name, factor, values in parts:
            held = np.cumsum(values**2) / max(float((values**2).sum()), 1e-300)
            shares = " ".join(f"{share:6.1%}" for share in held[: max(factor.shape[1], 1)][:8])
            lines.append(f"{name:<18}{factor.shape[1]:>4} {factor.shape[0]:>4}   {shares}")
        return "\n".join(lines)


@border
def demonstration_tensor(
    demonstrations: Sequence[Demonstration], samples: Samples = 100
) -> np.ndarray:
    """What all frames saw of all demonstrations, (T, P, d, N), evenly over their time.

    Demonstrations out of step are brought into step before, by :func:`tpsim.align`.

    Raises
    ------
    ArgumentError
        No demonstrations, or frames of different numbers or dimensions.
    """
    views = views_of(demonstrations, samples)
    dims = sorted({view.shape[2] for view in views})
    if len(dims) != 1:
        raise ArgumentError(
            f"the frames see {dims} dimensions; a tensor needs equal ones: leave out the frames "
            "of another kind"
        )
    return np.stack(views).transpose(2, 0, 3, 1)


@border
def eigenframes(
    demonstrations: Sequence[Demonstration],
    ranks: tuple[Count, Count, Count, Count] | None = None,
    *,
    samples: Samples = 100,
    share: Share = 0.99,
) -> Eigenframes:
    """Eigentrajectories, eigenframes and eigenposes of demonstrations (Section 9).

    Parameters
    ----------
    demonstrations : sequence of N Demonstration
        At least two, in step with each other, with frames of equal dimension and unit.
    ranks : four ints, optional
        Directions kept of progress, frames, dimensions and demonstrations; by default as few as
        keep ``share`` of the variance.
    samples : int
        Samples T of every movement.
    share : float
        Of the variance that is kept at least, where no ranks are given.

    Raises
    ------
    ArgumentError
        Fewer than two demonstrations, frames that do not fit together, or ranks beyond their mode.

    Notes
    -----
    Eigenframes are mixtures of views, such as the difference of two objects' places, which knows
    nothing of the movement any more. They tell how many frames there are and what varies
    together; models are fitted to the frames themselves (:func:`redundant_frames` says to which).
    """
    X = demonstration_tensor(demonstrations, samples)
    if X.shape[3] < 2:
        raise ArgumentError("one demonstration was given; give two or more, which can differ")
    mean = X.mean(3)
    deviation = X - mean[..., None]
    axes = _agreed_axes(deviation)
    turned = np.einsum("pab,tpbn->tpan", axes, deviation)
    spread = float(np.sqrt(np.mean(deviation**2)))
    if ranks is not None and any(r > most for r, most in zip(ranks, X.shape, strict=True)):
        raise ArgumentError(f"ranks are {ranks}; the demonstrations allow at most {X.shape}")
    return Eigenframes(mean, axes, tucker(turned, ranks, share=share), spread)


def views_of(demonstrations: Sequence[Demonstration], samples: int) -> list[np.ndarray]:
    """What every frame saw of all demonstrations, P arrays (N, T, d_j), evenly over their time."""
    if not demonstrations:
        raise ArgumentError("no demonstrations were given; give at least one demonstration")
    if short := [i for i, demonstration in enumerate(demonstrations) if len(demonstration) < 2]:
        raise ArgumentError(
            f"demonstrations[{short[0]}] has one sample; a movement has two or more"
        )
    seen = [demonstration.resampled(samples).observations for demonstration in demonstrations]
    shapes = {tuple(view.shape[1] for view in views) for views in seen}
    if len(shapes) != 1 or not seen[0]:
        raise ArgumentError(
            f"the demonstrations have views of dimensions {sorted(shapes)}; give the same frames, "
            "one at least, to all"
        )
    return [np.stack(views) for views in zip(*seen, strict=True)]


def _agreed_axes(deviation: np.ndarray) -> np.ndarray:
    """Orthonormal (P, d, d) that turn every frame's deviations nearest to those of all.

    Generalised Procrustes analysis, J. Gower, Psychometrika 40(1), 1975. Two frames that are
    fixed to one thing, turned against each other, see the same afterwards.
    """
    size = max(float(np.abs(deviation).max()), 1 / LARGEST)
    x = np.moveaxis(deviation / size, 1, 0)  # (P, T, d, N)
    P, _, d, _ = x.shape
    axes, reached = np.tile(np.eye(d), (P, 1, 1)), -np.inf
    cross = np.einsum("ptan,qtbn->pqab", x, x)  # of views p and q
    for _ in range(ROUNDS):
        gained = 0.0
        for p in range(P):
            to_others = np.einsum("qca,qab->cb", axes, cross[:, p]) - axes[p] @ cross[p, p]
            U, s, Vt = np.linalg.svd(to_others)
            if s[0] > 0:
                axes[p] = U @ Vt
            gained += float(s.sum())
        if gained - reached <= 1e-9 * abs(gained):
            break
        reached = gained
    return axes
