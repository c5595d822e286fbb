"""benchmark_DS_TP_trajGMM01: a task-parameterized trajectory-GMM (Fig. 12, third row).

Look for: position, velocity and acceleration instead of time: the smoothest of the model-based
rows.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "TP-trajGMM", (0, 0.25 * WIDTH), "a quarter of the object's width: frames carry the end"
)

if __name__ == "__main__":
    present(__file__, main, draw)
