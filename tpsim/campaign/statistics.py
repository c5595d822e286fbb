"""Statistics of many trials: shares, paired differences, what fails together, what moves what."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import ndtri

from tpsim.campaign.rows import Rows

RESAMPLES = 1000

_LARGE = 3000
"""Situations beyond which resampled means are as good as normal."""

FEWEST = 5
"""Trials in a cluster, at least."""


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval, of so many trials.

    Parameters
    ----------
    value, low, high : float
    trials : int
    """

    value: float
    low: float
    high: float
    trials: int

    def __str__(self) -> str:
        """Return it as text."""
        if not np.isfinite(self.value):
            return "–"
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


def share(kept: np.ndarray) -> Estimate:
    """Share of true values (N,) with its Wilson interval, Wilson 1927."""
    n = len(kept)
    low, high = wilson(np.array([np.sum(kept)]), np.array([n]))
    return Estimate(float(np.mean(kept)) if n else np.nan, float(low[0]), float(high[0]), n)


def wilson(count: np.ndarray, total: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Limits (k,) of the 95 % Wilson intervals of ``count`` (k,) out of ``total`` (k,)."""
    z = float(ndtri(0.975))
    # Of no trial nothing is known: from 0 to 1.
    p = count / np.maximum(total, 1)
    middle = (count + z**2 / 2) / (total + z**2)
    half = z * np.sqrt(total * p * (1 - p) + z**2 / 4) / (total + z**2)
    return np.maximum(middle - half, 0.0), np.minimum(middle + half, 1.0)


def mean(values: np.ndarray, units: np.ndarray, seed: int = 0) -> Estimate:
    """Mean of values (N,) with a 95 % interval over independent units (N,).

    Trials of one situation are no independent ones: situations are resampled, each with all its
    trials (percentile bootstrap); of very many, the interval is the normal one of the same mean.
    """
    there = np.isfinite(values)
    values, units = values[there], units[there]
    if not len(values):
        return Estimate(np.nan, np.nan, np.nan, 0)
    _, group = np.unique(units, return_inverse=True)
    sums, counts = np.bincount(group, values), np.bincount(group).astype(float)
    found, n = float(values.mean()), len(sums)
    if n == 1:
        return Estimate(found, np.nan, np.nan, len(values))
    if n > _LARGE:
        spread = np.sqrt(n / (n - 1) * np.sum((sums - found * counts) ** 2)) / counts.sum()
        half = float(ndtri(0.975) * spread)
        return Estimate(found, found - half, found + half, len(values))
    weights = np.random.default_rng(seed).multinomial(n, np.full(n, 1 / n), RESAMPLES)
    low, high = np.percentile((weights @ sums) / (weights @ counts), [2.5, 97.5])
    return Estimate(found, float(low), float(high), len(values))


def paired(rows: Rows, figure: str, by: str, one: str, other: str) -> tuple[np.ndarray, np.ndarray]:
    """Differences of a figure between trials that differ in one condition alone.

    Parameters
    ----------
    rows : Rows
    figure : str
    by : str
        ``"controller"`` or ``"plant"``.
    one, other : str
        Values of it; the second is taken from the first.

    Returns
    -------
    differences, units : (M,)
    """
    rest = "plant" if by == "controller" else "controller"
    values, code = np.unique(rows[rest], return_inverse=True)
    key = rows["point"].astype(int) * len(values) + code.reshape(-1)
    sides = []
    for side in (one, other):
        mask = rows[by] == side
        order = np.argsort(key[mask], kind="stable")
        sides.append((key[mask][order], rows[figure][mask][order], rows.units[mask][order]))
    _, a, b = np.intersect1d(sides[0][0], sides[1][0], return_indices=True)
    return sides[0][1][a] - sides[1][1][b], sides[0][2][a]


@dataclass(frozen=True)
class Cluster:
    """Conditions under which trials fail more often than they do at large.

    Parameters
    ----------
    conditions : tuple of (str, str)
    failed : Estimate
        Share that fails.
    lift : float
        That share over the share of all trials.
    """

    conditions: tuple[tuple[str, str], ...]
    failed: Estimate
    lift: float

    def row(self) -> dict[str, object]:
        """As a row of a table."""
        return {
            "conditions": ", ".join(f"{name} {value}" for name, value in self.conditions),
            "trials": self.failed.trials,
            "failed": f"{100 * self.failed.value:.1f} %",
            "95 % interval": f"{100 * self.failed.low:.1f} to {100 * self.failed.high:.1f} %",
            "lift": round(self.lift, 2),
        }


def clusters(
    conditions: Mapping[str, np.ndarray], failed: np.ndarray, most: int = 10
) -> tuple[list[Cluster], int]:
    """Combinations of up to three conditions that fail above the base rate, ranked by lift.

    A combination counts if the lower limit of its Wilson interval is above the rate of all trials
    and above that of every part of it.

    Parameters
    ----------
    conditions : mapping of str to (N,) texts
    failed : (N,) bool
    most : int
        Clusters, at most.

    Returns
    -------
    clusters : list of Cluster
    looked : int
        How many combinations were looked at: of these, one in forty lies above by chance.
    """
    base = float(failed.mean()) if len(failed) else 0.0
    if base in (0.0, 1.0):
        return [], 0
    rates: dict[frozenset[tuple[str, str]], float] = {frozenset(): base}
    found, looked = [], 0
    for size in (1, 2, 3):
        for cluster in _combined(conditions, failed, size):
            looked += 1
            parts = frozenset(cluster.conditions)
            above = max(rates.get(parts - {part}, base) for part in parts)
            rates[parts] = cluster.failed.value
            if cluster.failed.low > max(base, above if size > 1 else base):
                found.append(Cluster(cluster.conditions, cluster.failed, cluster.lift / base))
    return sorted(found, key=lambda c: -c.lift)[:most], looked


def _combined(
    conditions: Mapping[str, np.ndarray], failed: np.ndarray, size: int
) -> Iterator[Cluster]:
    """All combinations of values of so many conditions; their lift is not yet over the base."""
    coded = {name: np.unique(column, return_inverse=True) for name, column in conditions.items()}
    for names in combinations(coded, size):
        lengths = [len(coded[name][0]) for name in names]
        if np.prod(lengths) > len(failed):
            continue
        code = np.ravel_multi_index([coded[name][1].reshape(-1) for name in names], lengths)
        total = np.bincount(code, minlength=int(np.prod(lengths)))
        count = np.bincount(code, failed, minlength=len(total))
        low, high = wilson(count, total)
        for k in np.flatnonzero(total >= FEWEST):
            values = np.unravel_index(k, lengths)
            said = tuple((n, str(coded[n][0][v])) for n, v in zip(names, values, strict=True))
            rate = float(count[k] / total[k])
            yield Cluster(said, Estimate(rate, float(low[k]), float(high[k]), int(total[k])), rate)


def explained(values: np.ndarray, groups: np.ndarray) -> float:
    """Share of the variance of values (N,) that lies between groups (N,): the correlation ratio."""
    there = np.isfinite(values)
    values, groups = values[there], groups[there]
    if len(values) < 2 or not np.ptp(values):
        return float("nan")
    _, code = np.unique(groups, return_inverse=True)
    counts = np.bincount(code)
    means = np.bincount(code, values) / counts
    between = np.sum(counts * (means - values.mean()) ** 2)
    return float(between / np.sum((values - values.mean()) ** 2))
