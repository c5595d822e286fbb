"""benchmark_DS_TP_MFA01: a task-parameterized mixture of factor analysers (Fig. 12, second row).

Look for: one factor per component and frame does what full covariances do; the ends are as
precise. Far away the product of long components detours, as in benchmark_DS_TP_GMM01.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "TP-MFA",
    (0, 0.25 * WIDTH),
    "a quarter of the object's width: frames carry the end",
    angle=(0, 90),
)

if __name__ == "__main__":
    present(__file__, main, draw)
