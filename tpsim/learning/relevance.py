"""Which frames matter, and when (Section 9): shares of the precision that a TP-GMM learned."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpsim.border import checked
from tpsim.checks import Seed, dimensions, frozen, generator, instance, number, several, whole
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.frame import Frame
from tpsim.gaussian import Dimensions
from tpsim.learning.tp_gmm import TPGMM
from tpsim.timeline import phase, weights

MOST_DRAWS = 100_000
"""Exchanges of a frame in a test, at most."""


def frame_shares(
    model: TPGMM, frames: Sequence[Frame], dims: Dimensions | None = None
) -> np.ndarray:
    """Share of every frame in the precision of every component, (..., K, P).

    With the precisions Lambda_j = (A^+)' Sigma_j^-1 A^+ that add up to Lambda in Eq. (6), the
    share of frame j is tr(Lambda^-1 Lambda_j) / D: the fraction of the directions that it decides.
    Shares add up to one and do not depend on units, rotations or scalings of the common space.

    Parameters
    ----------
    model : TPGMM
        With P frames.
    frames : sequence of P Frame
        Moving frames have leading axes (T,).
    dims : sequence of int, optional
        Common dimensions that count, given the others; such as those after the time column,
        which all frames share.

    Raises
    ------
    ArgumentError
        As many frames as the model has, of its dimensions, are asked for.
    """
    frames = several("frames", frames, Frame)
    instance("model", model, TPGMM)
    expected = [(gaussian.dim, frames[0].dim) for gaussian in model.frames] if frames else []
    given = [(frame.local_dim, frame.dim) for frame in frames]
    if not given or given != expected:
        raise ArgumentError(
            f"frames have (d, D) = {given}; the model asks for d = {list(model.dims)} and one D"
        )
    D = frames[0].dim
    kept = dimensions("dims", np.arange(D) if dims is None else dims, D)
    precisions = []
    for frame, gaussian in zip(frames, model.frames, strict=True):
        inverse = frame.inverse[..., None, :, :]
        precisions.append((inverse.mT @ gaussian.precision @ inverse)[..., kept[:, None], kept])
    covariance = np.linalg.pinv(sum(precisions), rcond=1e-12, hermitian=True)
    shares = [np.einsum("...ab,...ba->...", covariance, part) for part in precisions]
    return np.stack(np.broadcast_arrays(*shares), axis=-1) / len(kept)


def frame_relevance(
    model: TPGMM, demonstration: Demonstration, dims: Dimensions | None = None
) -> np.ndarray:
    """Share of every frame over the time of a demonstration, (T, P).

    The shares of :func:`frame_shares`, averaged over components by their responsibilities,
    Eq. (49).
    """
    instance("demonstration", demonstration, Demonstration)
    shares = frame_shares(model, demonstration.frames, dims)
    h = model.responsibilities([demonstration])
    return (h[:, None, :] @ shares)[:, 0]


@dataclass(frozen=True, eq=False)
class FrameReport:
    """How much every frame mattered in a set of demonstrations.

    Parameters
    ----------
    mean : (P,)
        Mean share over the time of all demonstrations.
    peak : (P,)
        Largest share at any time of any demonstration.
    peak_progress : (P,)
        When that was: 0 at the start of the demonstration, 1 at its end.
    chance : (P,)
        Probability that a frame with nothing to do with the movement looks as relevant, from
        exchanging it between demonstrations; one where that says nothing.
    tested : (P,) bool
        Whether it says something: the frame differs between at least four demonstrations.
    significance : float
        Frames below this chance matter.
    """

    mean: np.ndarray
    peak: np.ndarray
    peak_progress: np.ndarray
    chance: np.ndarray
    tested: np.ndarray
    significance: float

    def __post_init__(self) -> None:
        checked(self)
        object.__setattr__(self, "tested", frozen(self.tested.astype(bool)))

    @property
    def never(self) -> tuple[int, ...]:
        """Frames that never matter: candidates to leave out (Section 9).

        Those that could as well be exchanged between the demonstrations; of the others, those
        that never reach an equal share, 1 / P.
        """
        weak = np.where(
            self.tested, self.chance > self.significance, self.peak < 1 / len(self.peak)
        )
        return tuple(int(j) for j in np.flatnonzero(weak))

    def __str__(self) -> str:
        """Table with one line per frame."""
        lines = ["frame   mean   peak     at   chance"]
        for j in range(len(self.peak)):
            chance = f"{self.chance[j]:.3f}" if self.tested[j] else "untested"
            verdict = "  never matters" if j in self.never else ""
            lines.append(
                f"{j:>5} {self.mean[j]:>6.0%} {self.peak[j]:>6.0%} {self.peak_progress[j]:>6.0%} "
                f"{chance:>8}{verdict}"
            )
        return "\n".join(lines)


def frame_report(
    model: TPGMM,
    demonstrations: Sequence[Demonstration],
    *,
    dims: Dimensions | None = None,
    significance: float = 0.05,
    draws: int = 400,
    rng: Seed = None,
) -> FrameReport:
    """Report which frames matter, when most, and which never do (Section 9).

    A frame that matters is one in which the movement varies less than if the frame had been
    taken from another demonstration. The report exchanges every frame at random between the
    demonstrations and compares the volumes of the covariances in K equal spans of progress; the
    largest standardised difference over the spans is the statistic, so that looking at many
    spans does not make a frame look relevant by chance. The components themselves would not do:
    EM has already fitted them to what the frame saw.

    Parameters
    ----------
    model : TPGMM
        Fitted to the demonstrations, or to others like them.
    demonstrations : sequence of Demonstration
        Where the frames are looked at.
    dims : sequence of int, optional
        As in :func:`frame_shares`.
    significance : float
        Between 0 and 1.
    draws : int
        Number of random exchanges.
    rng : numpy Generator, optional
        Draws them; default a fixed seed.

    Raises
    ------
    ArgumentError
        No demonstrations, frames other than the model's, or options outside their range.
    """
    demonstrations = several("demonstrations", demonstrations, Demonstration)
    if not demonstrations:
        raise ArgumentError("no demonstrations were given; give at least one demonstration")
    significance = number("significance", significance, above=0, below=1)
    draws, random = whole("draws", draws, least=1, most=MOST_DRAWS), generator("rng", rng, 0)
    shares = np.concatenate([frame_relevance(model, one, dims) for one in demonstrations])
    progress = np.concatenate([phase(one.time) for one in demonstrations])
    durations = np.array([max(float(np.ptp(one.time)), 1e-300) for one in demonstrations])
    durations /= durations.sum()
    lasting = np.concatenate(
        [share * weights(d.time) for share, d in zip(durations, demonstrations, strict=True)]
    )
    count = len(demonstrations)
    exchanges = np.array([np.arange(count), *(random.permutation(count) for _ in range(draws))])
    chances = [
        _chance(demonstrations, j, model.components, exchanges) for j in range(shares.shape[1])
    ]
    tested = np.array([chance is not None for chance in chances])
    return FrameReport(
        lasting @ shares,
        shares.max(0),
        progress[shares.argmax(0)],
        np.array([1.0 if chance is None else chance for chance in chances]),
        tested,
        significance,
    )


def _chance(
    demonstrations: list[Demonstration], j: int, spans: int, exchanges: np.ndarray
) -> float | None:
    """Share of random exchanges of frame j (all rows but the first) as good as none (the first).

    None where exchanging changes nothing, or where too few demonstrations can be exchanged.
    """
    if len(demonstrations) < 4:
        return None
    moments = np.array(
        [[_moments(one, other, j, spans) for other in demonstrations] for one in demonstrations]
    )
    volumes = _log_volumes(moments, exchanges)
    spread = volumes[1:].std(0)
    if not (spread > 1e-6).any():
        return None
    gain = (volumes[1:].mean(0) - volumes) / np.where(spread > 1e-6, spread, np.inf)
    statistic = gain.max(1)
    return float((statistic[1:] >= statistic[0]).sum() + 1) / len(statistic)


def _moments(one: Demonstration, other: Demonstration, j: int, spans: int) -> np.ndarray:
    """Sums of [1, x] [1, x]' per span of progress, x being one's data in the other's frame j."""
    frame = other.frames[j]
    done = phase(one.time)
    if frame.shape and other is not one:
        at = other.time[0] + done * (other.time[-1] - other.time[0])
        frame = other.resampled(np.minimum(at, other.time[-1])).frames[j]
    x = frame.to_local(one.data)
    x = np.column_stack([np.ones(len(x)), x])
    span = np.minimum((done * spans).astype(int), spans - 1)
    return (np.eye(spans)[:, span, None] * (weights(one.time)[:, None] * x)).mT @ x


def _log_volumes(moments: np.ndarray, exchanges: np.ndarray) -> np.ndarray:
    """Log determinant of every span's covariance after every exchange, (draws + 1, spans)."""
    total = moments[np.arange(len(moments)), exchanges].sum(1)
    total = total / np.maximum(total[..., :1, :1], 1e-300)
    mean = total[..., 0, 1:]
    covariance = total[..., 1:, 1:] - mean[..., :, None] * mean[..., None, :]
    # What does not vary at all must not decide: a millionth of each variable's own spread.
    spread = np.diagonal(covariance.mean((0, 1)))
    ridge = 1e-6 * np.where(spread > 0, spread, spread.max())
    return np.linalg.slogdet(covariance + ridge * np.eye(mean.shape[-1]))[1]
