"""benchmark_DS_TP_LWR01: locally weighted regression in every frame (Fig. 13, second row).

Look for: paths much like those of benchmark_DS_TP_GP01, for a fraction of the computation.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "TP-LWR", (0, 0.25 * WIDTH), "a quarter of the object's width: frames carry the end"
)

if __name__ == "__main__":
    present(__file__, main, draw)
