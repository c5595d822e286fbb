"""demo_GPR01: Gaussian processes from task parameters to trajectories and mixtures (Section 8.1).

Look for: both follow the frames near the demonstrations; far away they collapse to an average
movement, because nothing in them knows what a frame is (Figs 1 and 14). The spread of the process
grows with the distance; a mixture that was regressed does not know that it is far.
"""

from functools import cache

import _situations as shared

from tpsim.gallery import present, within


@cache
def retrieve():
    """Learn both from the same demonstrations; situations go from near to far."""
    return {name: shared.adapt(shared.learn(name)) for name in ("GPR", "GPR-GMM")}


def main():
    figures = {}
    for name, paths in retrieve().items():
        near, *_, far = shared.errors(paths, "end")
        figures[f"{name}_end_error_near_m"] = within(
            near, 0, 0.5 * shared.WIDTH, "the end is inside the second object"
        )
        figures[f"{name}_end_error_far_m"] = within(
            far, 0.5 * shared.WIDTH, 2.0, "outside the object: a GP returns to its mean"
        )
    spread = [path.covariance[0, 0, 0] ** 0.5 for path in retrieve()["GPR"]]
    figures["GPR_spread_far_over_near"] = within(
        spread[-1] / spread[0], 2, 100, "the variance grows with the distance to the data, Eq. 47"
    )
    return figures


def draw(figure):
    shared.draw(figure, *retrieve().values(), names=list(retrieve()))


if __name__ == "__main__":
    present(__file__, main, draw)
