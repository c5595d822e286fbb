"""figure06: one dancer's motion retrieved from the other's, D = 94 (Section 4.2, Fig. 6).

Look for: in a dance that was not demonstrated, the retrieved partner (black) steps with the leader,
faces him and keeps hold of his hand. 12 factor analysers with 2 factors have a twelfth of the
parameters of full covariances. The dances are synthetic.
"""

from functools import cache

import numpy as np
from _dancers import BONES, TIME, Dance, bones_of, heading_of, turned

from tpsim import GMM, MFA, Demonstration, Frame, fit_tp_gmm, gmr, plot
from tpsim.gallery import present, within

K, D, d = 12, 1 + 3 * 31, 2


def seen_from(leader):
    """Frame (T,) of the leader: his heading, and his joint for each joint of the partner."""
    A = np.einsum("ab,tij->taibj", np.eye(31), turned(heading_of(leader)))
    return Frame(A.reshape(-1, 93, 93), leader.reshape(-1, 93))


@cache
def dance():
    """Learn four dances; leader, partner and retrieved partner (T, 31, 3) of a fifth."""
    rng, taught = np.random.default_rng(0), []
    for _ in range(4):
        leader, partner = Dance.drawn(rng).dancers()
        motion = Demonstration(TIME, partner.reshape(-1, 93), [seen_from(leader)])
        taught.append(motion.with_time())
    views = [np.concatenate([motion.observations[0] for motion in taught])]
    model = fit_tp_gmm(views, K, covariance=MFA(d), start="time")
    leader, partner = Dance.drawn(np.random.default_rng(7), spread=1.5).dancers()
    local = gmr(GMM(model.priors, model.frames[0]), TIME[:, None]).mean
    retrieved = seen_from(leader).to_common(local).reshape(-1, 31, 3)
    average = np.mean([motion.data[:, 1:] for motion in taught], axis=0).reshape(-1, 31, 3)
    return model, leader, partner, retrieved, average


def main():
    model, _, partner, retrieved, average = dance()
    rms, without = (
        np.sqrt(((path - partner) ** 2).sum(-1).mean()) for path in (retrieved, average)
    )
    stretch = np.abs(bones_of(retrieved) / bones_of(partner) - 1)
    full, counted = K * (D + D * (D + 1) // 2) + K - 1, "the caption of Fig. 6"
    return {
        "parameters": within(model.free_parameters, 4511, 4511, counted),
        "parameters_full": within(full, 54719, 54719, counted),
        "rms_joint_error_m": within(
            rms, 0, 0.03, "the distance between the dancers varies by 0.04"
        ),
        "rms_without_frame_m": within(
            without, 10 * rms, 2.0, "without the frame, the average of dances in other places"
        ),
        "median_bone_stretch": within(np.median(stretch), 0, 0.02, "bones keep their length"),
    }


def draw(figure):
    _, leader, partner, retrieved, _ = dance()
    dancers = {"partner": (partner, "#b5b8bd", 4.5), "leader": (leader, plot.PALETTE[1], 1.5)}
    dancers["partner, retrieved"] = retrieved, plot.INK, 2.0
    axes = plot.panels(figure, 1, 5, size=(1.9, 3.0))
    for axis, t in zip(axes, (0, 20, 40, 60, 80), strict=True):
        camera = turned(heading_of(leader)[t] + 0.5)
        for name, (joints, colour, width) in dancers.items():
            seen = ((joints[t] - leader[t, 0]) @ camera)[:, [0, 2]] + [0, leader[t, 0, 2]]
            plot.skeleton(axis, seen, BONES, colour, width=width, label=name)
        plot.title(axis, f"{TIME[t]:.1f} s")
        axis.set(xticks=[], yticks=[0, 1] if t == 0 else [])
    axes[0].set_ylabel("height [m]")
    plot.same_view(axes)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
