"""demo_TPtrajGMM01: a TP-GMM over position, velocity and acceleration (Section 5.2, Fig. 12).

Look for: no time in the model, yet a smooth movement: a sequence of states says where, how fast
and with what acceleration, and the most likely trajectory agrees with all three (Eq. 30).
"""

from functools import cache

import _situations as shared

from tpsim import fit_tp_gmm, trajectory_of_states
from tpsim.gallery import present


@cache
def retrieve():
    """Learn [x, dx, ddx] in two frames; states follow each other as in the demonstrations."""
    moving = [d.with_derivatives(2) for d in shared.TAUGHT]
    model = fit_tp_gmm(moving, 3, start="time")
    states = model.responsibilities(moving).reshape(len(moving), -1, 3).mean(0).argmax(1)
    dt = moving[0].time[1]

    def adapted(frames):
        gmm = model.adapt([frame.with_derivatives(2) for frame in frames])
        return trajectory_of_states(gmm, states, dt)

    return shared.adapt(adapted)


main, draw = shared.row(retrieve)

if __name__ == "__main__":
    present(__file__, main, draw)
