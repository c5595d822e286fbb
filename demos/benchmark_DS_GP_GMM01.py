"""benchmark_DS_GP_GMM01: a Gaussian process from task parameters to mixtures (Fig. 14, second row).

Look for: regressing the parameters of a mixture helps near the demonstrations, not far from them.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "GPR-GMM", (0.5 * WIDTH, 2.0), "outside the object: a regression does not extrapolate"
)

if __name__ == "__main__":
    present(__file__, main, draw)
