"""benchmark_DS_TP_GMM01: a task-parameterized Gaussian mixture (Fig. 12, first row).

Look for: the movement ends inside the second object in all four situations, however far: the
frame of the object carries its end along.
"""

from _benchmark import benchmark
from _situations import WIDTH

from tpsim.gallery import present

main, draw = benchmark(
    "TP-GMM", (0, 0.25 * WIDTH), "a quarter of the object's width: frames carry the end"
)

if __name__ == "__main__":
    present(__file__, main, draw)
