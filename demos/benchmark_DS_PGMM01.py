"""benchmark_DS_PGMM01: a parametric Gaussian mixture (Fig. 14, third row).

Look for: the centres follow the task by an affine map and find the object, but the covariances stay
as they were taught: in the far situation the movement comes in through a wall.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark("PGMM", (0, WIDTH), "an affine map of the positions", angle=(60, 180))

if __name__ == "__main__":
    present(__file__, main, draw)
