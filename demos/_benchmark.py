"""What the eight benchmark rows share: learn an attractor, retrieve it, follow it (Figs 12 to 14).

Every demonstration is encoded as the path of the attractor to which a spring and a damper would
have to be tied to make that movement; a method of Section 8 adapts it to the new situation, and
the same spring and damper make the movement again.
"""

from collections.abc import Sequence
from functools import cache

import _situations as shared
import numpy as np

from tpsim import Demonstration, Gaussian, Motion, attractor_path, spring_damper
from tpsim.gallery import Bounded, Draw, Main, within

STIFFNESS, DAMPING = 100.0, np.sqrt(200.0)


def encode(demonstrations: Sequence[Demonstration]) -> list[Demonstration]:
    """Attractors instead of movements, seen from the same frames."""
    return [
        Demonstration(d.time, attractor_path(_motion(d), STIFFNESS, DAMPING), d.frames)
        for d in demonstrations
    ]


def follow(attractor: np.ndarray, start: np.ndarray, dt: float) -> np.ndarray:
    """Movement (T, 2) of the mass that is tied to the attractor."""
    state = np.r_[start, 0.0, 0.0]
    return spring_damper(attractor, STIFFNESS, DAMPING, dt, state).states[:, :2]


def benchmark(
    method: str, end: tuple[float, float], reason: str, angle: tuple[float, float] = (0, 60)
) -> tuple[Main, Draw]:
    """Functions ``main`` and ``draw`` of one row.

    In the farthest situation ``end`` bounds the error of the last point [m], for the given
    ``reason``, and ``angle`` the angle between the last piece and the open side [deg].
    """

    @cache
    def retrieve() -> tuple[list, list]:
        paths = shared.adapt(shared.learn(method, encode(shared.TAUGHT)))
        dt = float(shared.TAUGHT[0].time[1])
        ways = [
            follow(path.mean, frames[0].b, dt)
            for path, frames in zip(paths, shared.SITUATIONS, strict=True)
        ]
        return paths, ways

    def main() -> dict[str, Bounded]:
        paths = [Gaussian(way, np.zeros((len(way), 2, 2))) for way in retrieve()[1]]
        ends, angles = shared.errors(paths, "end"), shared.errors(paths, "entry")
        near = "near the taught situations every method works: within the object"
        side = "0 is straight through the open side of the U, 90 is through a wall"
        return {
            "end_error_nearest_m": within(ends[0], 0, 0.5 * shared.WIDTH, near),
            "end_error_farthest_m": within(ends[-1], *end, reason),
            "entry_angle_farthest_deg": within(angles[-1], *angle, side),
        }

    def draw(figure) -> None:
        paths, ways = retrieve()
        shared.draw(figure, paths, names=(method,), tracks=ways)

    return main, draw


def _motion(demonstration: Demonstration) -> Motion:
    return Motion.of(demonstration.data, float(demonstration.time[1] - demonstration.time[0]))
