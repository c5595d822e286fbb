"""benchmark_DS_GP_raw01: a Gaussian process from task parameters to paths (Fig. 14, first row).

Look for: far from what was taught the movement collapses to an average and misses the object.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "GPR", (0.5 * WIDTH, 2.0), "outside the object: a regression does not extrapolate"
)

if __name__ == "__main__":
    present(__file__, main, draw)
