"""How a trial followed both objects, beside the least distances that the body allows."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tpsim.study.measure import rms
from tpsim.tasks.tracking.body import Body


@dataclass(frozen=True)
class Outcome:
    """How one trial followed both objects, hand by hand.

    Parameters
    ----------
    together : dict of str to float
        Distance [m] to the object while both are in reach, rms.
    apart : dict of str to float
        The same while they are not.
    ratio : dict of str to float
        Mean distance while they are not, over the one that the teaching asks for; NaN where it
        asks for none.
    """

    together: Mapping[str, float]
    apart: Mapping[str, float]
    ratio: Mapping[str, float]

    @classmethod
    def of(
        cls,
        reached: Mapping[str, np.ndarray],
        objects: Mapping[str, np.ndarray],
        body: Body,
        teaching: str,
    ) -> "Outcome":
        """Compare distances with what the body can reach at most, as a teaching has it.

        Parameters
        ----------
        reached : mapping of str to (T,)
            Distance of each hand from its object [m].
        objects : mapping of str to (T, 2)
            Where the objects are [m].
        body : Body
        teaching : str
        """
        angle, apart = body.lean(objects["left"], objects["right"], teaching)
        least = {side: body.missing(angle, p)[apart].sum() for side, p in objects.items()}
        return cls(
            {side: _rms(away[~apart]) for side, away in reached.items()},
            {side: _rms(away[apart]) for side, away in reached.items()},
            {
                side: float(away[apart].sum() / least[side]) if least[side] > 1e-6 else np.nan
                for side, away in reached.items()
            },
        )


def _rms(values: np.ndarray) -> float:
    return rms(values) if len(values) else 0.0
