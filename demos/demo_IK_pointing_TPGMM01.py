"""demo_IK_pointing_TPGMM01: point at two objects, then return to a posture (Eqs 40-42, Fig. 10).

Look for: the product of four frames knows when which of them counts, for moving objects too. The
thick posture points at the object of its panel; the last one is back where it began.
"""

from functools import cache

import _pointing as shared
import numpy as np

from tpsim import Regression, fit_tp_gmm, plot
from tpsim.gallery import present, within

MOMENTS = {"at the first": 45, "at the second": 95, "back": 149}
SPEEDS = {"resting": 0.0, "moving": 0.1}


@cache
def reproduce():
    """Learn from six demonstrations; objects, postures and errors in two new situations."""
    rng, found = np.random.default_rng(0), {}
    draws = [shared.OBJECTS + rng.uniform(-0.1, 0.1, (2, 2)) for _ in range(8)]
    views = [shared.seen(*shared.move(shared.teach, objects)) for objects in draws[:6]]
    model = fit_tp_gmm([np.vstack(view) for view in zip(*views, strict=True)], 6, start="time")

    def act(t, q, objects):
        frames = [frame.with_input() for frame in shared.frames_at(q, objects)]
        return Regression.of(model.adapt(frames)).at(shared.TIME[t]).mean

    for (name, speed), objects in zip(SPEEDS.items(), draws[6:], strict=True):
        found[name] = objects, *shared.move(act, objects, speed)
    return found


def main():
    figures, good = {}, "the width of an object seen from 1 m: a degree or two"
    for name, (_, q, errors) in reproduce().items():
        first, second = np.rad2deg(np.abs([errors[35:50, 0], errors[85:100, 1]]).mean(1))
        figures[f"first_{name}_deg"] = within(first, 0, 1, good)
        figures[f"second_{name}_deg"] = within(second, 0, 1, good)
        back = np.abs(q[-1] - shared.START).max()
        figures[f"posture_{name}_rad"] = within(
            back, 0, 0.02, "a degree: every demonstration ends in this posture"
        )
    return figures


def draw(figure):
    axes = plot.panels(figure, 2, 3, size=(3.0, 1.9))
    for i, (name, (start, q, _)) in enumerate(reproduce().items()):
        for axis, (moment, t) in zip(axes[3 * i :], MOMENTS.items(), strict=False):
            objects = start + np.outer([0, t * shared.DT], [0, SPEEDS[name]])
            plot.arm(axis, shared.ARM, q[max(t - 44, 0) : t + 1 : 11], label="arm, light to dark")
            ray = np.outer([0, 0.9], [np.cos(q[t].sum()), np.sin(q[t].sum())])
            axis.plot(*(shared.ARM.position(q[t]) + ray).T, ":", color=plot.INK, label="direction")
            for place, colour, label in zip(
                objects, plot.PALETTE, ("first", "second"), strict=False
            ):
                plot.points(axis, place, colour, label=f"{label} object")
            axis.set_xlabel("x [m]" if i == 1 else "")
            plot.title(axis, moment if i == 0 else "")
        axes[3 * i].set_ylabel(f"second {name}\ny [m]")
    plot.same_view(axes)
    plot.legend(figure)


if __name__ == "__main__":
    present(__file__, main, draw)
