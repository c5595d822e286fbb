"""benchmark_DS_TP_GP01: a Gaussian process in every frame (Fig. 13, first row).

Look for: no mixture at all, and the frames alone carry the movement to the far situations.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "TP-GP", (0, 0.25 * WIDTH), "a quarter of the object's width: frames carry the end"
)

if __name__ == "__main__":
    present(__file__, main, draw)
