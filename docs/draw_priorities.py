"""Draw docs/priorities.png: where Eq. (44) comes to rest, as printed and as a Newton step.

Run it after its numbers have changed: ``python docs/draw_priorities.py``.
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib.figure import Figure

from tpsim import projection
from tpsim.catalogue.ours import planar5
from tpsim.plot.style import INK, PALETTE, panels, save
from tpsim.tasks.tracking.body import SIDES, Body

ROBOT = planar5()
BODY = Body.of(ROBOT)
PAIRS, STEPS, GAIN, DAMPING = 8, 400, 0.15, 0.01
LAWS = {
    "$N\\tilde{J}^+$, as printed": {},
    "$N(\\tilde{J}N)^+$": {"bend": 0.0},
    "Newton step": {"bend": 0.3},
}


def objects(rng):
    """Two places, 0.3 to 0.6 rad farther apart than both hands reach."""
    heading, far = np.pi / 2 + rng.uniform(-0.4, 0.4), rng.uniform(0.72, 0.88, 2)
    half = (BODY.half_width(far).sum() + rng.uniform(0.3, 0.6)) / 2
    bearings = heading + half, heading - half
    return np.array([[r * np.cos(a), r * np.sin(a)] for r, a in zip(far, bearings, strict=True)])


def follow(places, options):
    """Postures (STEPS, 5) and distances (STEPS, 2) [m] of both hands from their objects."""
    angle, _ = BODY.lean(places[:1], places[1:], "compromise")
    q, postures, distances = BODY.posture(angle[0], places[0], 0.8 * places[0] * [-1, 1]), [], []
    for _ in range(STEPS):
        state = ROBOT.at(q)
        (x, J), (other, J_other) = (
            (state.pose(f"{side}_hand").position[:2], state.jacobian(f"{side}_hand")[:2])
            for side in SIDES
        )
        frames = (
            projection.relative(J, q, x, np.eye(2), places[0], damping=DAMPING),
            projection.nullspace_relative(
                J, q, J_other, other, np.eye(2), places[1], damping=DAMPING, **options
            ),
        )
        postures.append(q)
        distances.append(np.linalg.norm(places - [x, other], axis=1))
        q = q + GAIN * np.clip(sum(frame.b - q for frame in frames), -0.5, 0.5)
    return np.array(postures), np.array(distances)


def main():
    """Three panels: a pair of arms at rest, both hands over the steps, the second one's ends."""
    figure, rng = Figure(), np.random.default_rng(0)
    arms, first, second = panels(figure, 1, 3, kind="curve", size=(3.6, 3.0))
    pairs = [objects(rng) for _ in range(PAIRS)]
    for colour, (name, options) in zip(PALETTE, LAWS.items(), strict=False):
        ratios, firsts = [], []
        for k, places in enumerate(pairs):
            postures, distances = follow(places, options)
            lean, _ = BODY.lean(places[:1], places[1:], "left")
            ratio = distances[:, 1] / BODY.missing(lean, places[1:])[0]
            ratios.append(ratio[-50:].mean())
            firsts.append(1e3 * distances[-50:, 0].mean())
            first.plot(1e3 * distances[:, 0], color=colour, lw=0.8)
            second.plot(ratio, color=colour, lw=0.8, label=name if k == 0 else None)
            if k == 0:
                state = ROBOT.at(postures[-1])
                for side in SIDES:
                    way = [state.pose(f"{side}_{part}").position for part in ("elbow", "hand")]
                    shoulder = state.pose(f"{side}_shoulder").position
                    x, y, _ = np.array([np.zeros(3), shoulder, *way]).T
                    arms.plot(x, y, "-o", color=colour, ms=3, lw=1.5)
        print(
            f"{name}: first hand {min(firsts):.1f} to {max(firsts):.1f} mm off, second "
            f"{min(ratios):.2f} to {max(ratios):.2f} of the least distance"
        )
    arms.plot(*pairs[0].T, "x", color=INK, ms=8)
    arms.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", title="at rest")
    first.set(xlabel="step", ylabel="first hand from its object [mm]", ylim=(0, 100))
    second.set(xlabel="step", ylabel="second hand, over the least distance", ylim=(0, 3))
    second.axhline(1.0, color=INK, lw=0.8)
    second.legend(fontsize=7)
    save(figure, Path(__file__).with_name("priorities.png"))


if __name__ == "__main__":
    main()
