"""demo_IK_nullspace_TPGMM01: priorities of two hands, learned as frames (Eqs 41, 44, Fig. 11).

Look for: where new targets part too far, the hand that the teacher served first is served first.
Top: demonstrations; bottom: the same model with targets that go somewhere else.
"""

from functools import cache, partial

import _priorities as shared
import numpy as np

from tpsim import Gaussian, fit_tp_gmm, plot
from tpsim.gallery import present, within

SHARES = {"left first": 1.0, "compromise": 0.5, "right first": 0.0}
TAUGHT, NEW = shared.targets([0.5, 0.2]), shared.targets([0.4, 0.4])


@cache
def learn(name):
    """Postures of the demonstration and of the reproduction."""
    share = SHARES[name]
    order = np.array([share, share, 1 - share, 1 - share])
    q, views = shared.move(lambda q, frames: q + order @ [f.b - q for f in frames], TAUGHT)
    model = fit_tp_gmm(views, 1, ridge=1e-5)
    prior = Gaussian(shared.START, 100 * np.eye(5))  # the two hands leave one direction open
    adapt = partial(model.adapt, prior=prior)
    return q, shared.move(lambda q, frames: adapt(frames).gaussians.mean[0], NEW)[0]


def main():
    figures = {}
    for name, share in SHARES.items():
        left, right = shared.errors(learn(name)[1], NEW)
        served, other = (left, right) if share >= 0.5 else (right, left)
        most = 0.05 if share != 0.5 else 0.45
        reason = "served first: only the lag of the step" if share != 0.5 else "half each"
        figures[f"{name}_served_m"] = within(served, 0, most, reason)
        figures[f"{name}_other_m"] = within(
            other, 0.2, 0.8, "the targets part farther than it reaches"
        )
    return figures


def draw(figure):
    axes = plot.panels(figure, 2, 3, size=(3.1, 1.7))
    for i, axis in enumerate(axes):
        name, goals = list(SHARES)[i % 3], (TAUGHT, NEW)[i // 3]
        q = learn(name)[i // 3][[0, 25, 50, 75]]
        for arm, goal, colour in zip(
            (shared.LEFT, shared.RIGHT), (0, 1), plot.PALETTE, strict=False
        ):
            plot.arm(axis, arm, q, colour, label=("left arm", "right arm")[goal])
            axis.plot(*goals[:, goal].T, color=plot.INK, lw=1.2, ls="--", label="targets", zorder=3)
        plot.points(axis, goals[75], marker="X", label="targets, farthest out")
        plot.title(axis, name if i < 3 else "")
        if i % 3 == 0:
            axis.set_ylabel(("demonstration", "reproduction")[i // 3] + "\ny [m]")
        axis.set_xlabel("x [m]" if i > 2 else "")
    plot.same_view(axes)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
