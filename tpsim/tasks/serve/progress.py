"""How far serving has come, from what both hands are seen to do: no clock.

Their way is what all frames retrieve of it together, in the present situation; where they are along
it is inferred by the forward variable of a semi-Markov chain whose ticks may stand still or hurry
(:mod:`tpsim.retrieval.progress`). Both arms share that of the hand that is behind: who holds one
stops the other.
"""

from collections.abc import Sequence

import numpy as np

from tpsim import rotation
from tpsim.control.poses import SeenMovement, fuse_poses
from tpsim.controllers.progress import Ahead, ByState
from tpsim.gaussian import Gaussian
from tpsim.learning.gmm import GMM
from tpsim.learning.semi_markov import SemiMarkovChain
from tpsim.learning.tp_gmm import TPGMM
from tpsim.pose import Pose
from tpsim.retrieval.gmr import Regression
from tpsim.retrieval.progress import Pace
from tpsim.retrieval.tp_gmr import at_equal_input
from tpsim.robot.state import State
from tpsim.robot.views.sites import Site, SiteView, as_rotation

MOVED = 1e-4
"""Change of an object's position [m] or rotation matrix after which the way is another one."""

WORLD = Pose(np.eye(3), np.zeros(3))
"""From where the base sees."""


PACE = Pace(np.array([0.05, 0.9, 0.05]), 0.9)
"""Nobody interferes, as a rule; who does goes on for a third of a second."""

_EACH = np.repeat([1.0, 5.0], 3)

STRAY, SLIP = 0.008 * _EACH, 0.2 * _EACH
"""How far [m], [rad] a hand may be from its way besides what was taught, and the deviation of its
velocity [m/s], [rad/s]. What is retrieved of the speed is uneven, so that it tells little: hands
that rest between two Gaussians would be taken for hands that are held."""


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
        What sees the position of the other hand, by its frame.
    between : int
        Frame of the other hand's position as seen from the hand with the cup.
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
        between: int,
        hands: tuple[str, str],
        until: float,
        dt: float,
    ):
        times = np.linspace(0.0, until, round(until / dt) + 1)

        def retrieved(frame: int) -> Gaussian:
            view = Regression.of(GMM(model.priors, model.frames[frame]))
            return at_equal_input([view], times, "pooled")[1][0][:, 0]

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
        self._between = retrieved(between)
        clock = GMM(model.priors, model.frames[0].marginal([0]))
        stays = clock.responsibilities(times[:, None]).argmax(1)
        chain = SemiMarkovChain.along(stays)
        self._cup_hand = ByState(chain, dt, PACE, STRAY, SLIP)
        self._sugar_hand = ByState(chain, dt, PACE, STRAY[:3], SLIP[:3])
        self._ahead = Ahead()
        self._seen: np.ndarray | None = None

    def at(self, state: State, time: float) -> tuple[float, float]:
        """Time within the movement [s], and how much of it passes per second."""
        names = dict.fromkeys([*self._cup, *(base for base, _ in self._sugar)])
        poses = {name: WORLD if name is None else state.objects[name].pose for name in names}
        seen = np.concatenate([part.ravel() for pose in poses.values() for part in pose])
        if self._seen is None or np.abs(seen - self._seen).max() > MOVED:
            self._seen = seen
            self._follow(poses)
        # What we move ourselves is no evidence that nobody holds the other hand.
        place = min(hand.at(state, time)[0] for hand in (self._cup_hand, self._sugar_hand))
        return self._ahead.of(place, time)

    def _follow(self, poses: dict[str | None, Pose]) -> None:
        """From now on, objects are at these poses."""
        bases = [poses[name] for name in self._cup]
        reference = bases[0].rotation @ self._movements[0].reference
        _, precisions, fused = fuse_poses(self._movements, bases, reference)
        known = np.zeros((len(fused), 9, 9))
        known[:, :6, :6] = precisions.sum(0)
        information = np.zeros((len(fused), 3))
        for (R, p), part in ((poses[name], part) for name, part in self._sugar):
            precision = R @ part.precision @ R.T
            known[:, 6:, 6:] += precision
            information += np.einsum("tij,tj->ti", precision, part.mean @ R.T + p)
        other = np.linalg.solve(known[:, 6:, 6:], information[..., None])[..., 0]
        # As the hand with the cup sees the other one, both give way: one Gauss-Newton step.
        turned, away = rotation.exp(fused[:, 3:]) @ reference, other - fused[:, :3]
        back = turned.mT
        lever = np.concatenate(
            [-back, back @ rotation.skew(away) @ rotation.left_jacobian(fused[:, 3:]), back], axis=2
        )
        error = self._between.mean - (back @ away[..., None])[..., 0]
        pull = lever.mT @ self._between.precision
        known += pull @ lever
        step = np.linalg.solve(known, pull @ error[..., None])[..., 0]
        places = Gaussian.trusted(np.hstack([fused, other]) + step, np.linalg.inv(known))
        self._cup_hand.follow(
            SiteView(self._site, None, "pose", as_rotation(reference)), places.marginal(range(6))
        )
        self._sugar_hand.follow(self._other, places.marginal(range(6, 9)))
