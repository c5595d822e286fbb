"""How far serving has come, from what both hands are seen to do: no clock.

Their way is what all frames retrieve of it together, in the present situation; where they are along
it is inferred by the forward variable of a semi-Markov chain whose ticks may stand still or hurry
(:mod:`tpsim.retrieval.progress`). Both arms share it: who holds one stops the other.
"""

from collections.abc import Callable, Sequence

import numpy as np

from tpsim import rotation
from tpsim.control.poses import SeenMovement, fuse_poses
from tpsim.controllers.progress import ByState
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.tp_gmm import TPGMM
from tpsim.pose import Pose
from tpsim.retrieval.gmr import gmr
from tpsim.retrieval.passage import Passage
from tpsim.retrieval.progress import Pace
from tpsim.robot.state import State
from tpsim.robot.views.sites import Site, SiteView, as_rotation
from tpsim.robot.views.view import Seen

MOVED = 1e-4
"""Change of an object's position [m] or rotation matrix after which the way is another one."""

CUP_HAND = "left"
"""The hand with the cup, as what sees the other one."""

WORLD = Pose(np.eye(3), np.zeros(3))
"""From where the base sees."""


PACE = Pace(np.array([0.05, 0.95]), 0.5)
"""Nobody interferes, as a rule."""

_EACH = np.repeat([1.0, 5.0, 1.0], 3)

STRAY, SLIP = 0.02 * _EACH, 0.2 * _EACH
"""How far [m], [rad] hands may be from their way besides what was taught, and the deviation of
their velocities [m/s], [rad/s]: between docks they are soft, and behind."""


LEAD = 0.12
"""How far ahead of where the hand is the movement is asked for [s]: what pulls it on from rest."""


class _SoftHands(ByState):
    """As hands that are held softly are seen."""

    def follow(self, see: Callable[[State], Seen], places: Gaussian) -> None:
        """See the hands along another movement from now on."""
        # Of most moments: while the cup is tilted, how far it is differs most between lessons.
        usual = np.median(np.diagonal(places.covariance, axis1=1, axis2=2), axis=0)
        spread = np.diag(usual + STRAY**2)
        alike = Gaussian.trusted(places.mean, np.broadcast_to(spread, places.covariance.shape))
        self._see = see
        self._passage = Passage(self._filter.chain, alike, self._dt, SLIP)


class HandsProgress:
    """Says when in the movement both hands are, and how fast they go on.

    Parameters
    ----------
    model : TPGMM
        Its frames have time before the view.
    cup : sequence of (str or None, int, int, (3, 3))
        What sees the hand with the cup: object (None is the base), frame of its position, frame of
        its orientation, and the rotation about which orientation is charted.
    sugar : sequence of (str or None, int)
        What sees the position of the other hand, by its frame; ``"left"`` is the hand with the cup.
    hands : (str, str)
        Sites of the hand with the cup and of the other one.
    until, dt : float
        Time of the movement, and of one tick [s].
    """

    def __init__(
        self,
        model: TPGMM,
        cup: Sequence[tuple[str | None, int, int, np.ndarray]],
        sugar: Sequence[tuple[str | None, int]],
        hands: tuple[str, str],
        until: float,
        dt: float,
    ):
        times = np.linspace(0.0, until, round(until / dt) + 1)

        def retrieved(frame: int) -> Gaussian:
            return gmr(GMM(model.priors, model.frames[frame]), times)

        self._cup = [base for base, *_ in cup]
        self._site, self._other = hands[0], Site(hands[1]).position
        self._movements = []
        for _, *frames, reference in cup:
            parts = [retrieved(frame) for frame in frames]
            precision = np.zeros((len(times), 6, 6))
            precision[:, :3, :3], precision[:, 3:, 3:] = (part.precision for part in parts)
            mean = np.hstack([part.mean for part in parts])
            self._movements.append(SeenMovement(mean, precision, reference))
        self._sugar = [(base, retrieved(frame)) for base, frame in sugar]
        clock = GMM(model.priors, model.frames[0].marginal([0]))
        stays = clock.responsibilities(times[:, None]).argmax(1)
        self._progress = _SoftHands(SemiMarkovChain.along(stays), dt, PACE)
        self._seen: np.ndarray | None = None
        self._view: SiteView | None = None

    def at(self, state: State, time: float) -> tuple[float, float]:
        """Time within the movement [s], and how much of it passes per second."""
        names = dict.fromkeys([*self._cup, *(base for base, _ in self._sugar)])
        poses = {
            name: state.objects[name].pose for name in names if name not in (None, CUP_HAND)
        } | {None: WORLD}
        seen = np.concatenate([part.ravel() for pose in poses.values() for part in pose])
        if self._seen is None or np.abs(seen - self._seen).max() > MOVED:
            self._seen = seen
            self._follow(poses)
        place, rate = self._progress.at(state, time)
        return place + LEAD, rate

    def _hands(self, state: State) -> Seen:
        """Pose of the hand with the cup, over the position of the other one (9,)."""
        assert self._view is not None
        cup, other = self._view(state), self._other(state)
        return Seen(*(np.concatenate(parts) for parts in zip(cup[:3], other[:3], strict=True)))

    def _follow(self, poses: dict[str | None, Pose]) -> None:
        """From now on, objects are at these poses."""
        bases = [poses[name] for name in self._cup]
        reference = bases[0].rotation @ self._movements[0].reference
        _, precisions, fused = fuse_poses(self._movements, bases, reference)
        self._view = SiteView(self._site, None, "pose", as_rotation(reference))
        cup_hand = Pose(rotation.exp(fused[:, 3:]) @ reference, fused[:, :3])
        precision, information = np.zeros((len(fused), 3, 3)), np.zeros((len(fused), 3))
        for name, part in self._sugar:
            R, p = cup_hand if name == CUP_HAND else poses[name]
            known = R @ part.precision @ np.swapaxes(R, -1, -2)
            precision += known
            mean = (R @ part.mean[..., None])[..., 0] + p
            information += (known @ mean[..., None])[..., 0]
        covariance = np.zeros((len(fused), 9, 9))
        covariance[:, :6, :6] = np.linalg.inv(precisions.sum(0))
        covariance[:, 6:, 6:] = np.linalg.inv(precision)
        other = (covariance[:, 6:, 6:] @ information[..., None])[..., 0]
        self._progress.follow(self._hands, Gaussian.trusted(np.hstack([fused, other]), covariance))
