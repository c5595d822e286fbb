"""benchmark_DS_GP_raw01: a Gaussian process from task parameters to paths (Fig. 14, first row).

Look for: far from what was taught the movement collapses to an average: it misses the object, and
comes from where it always came.
"""

from _benchmark import without_frames

from tpsim.gallery import present

main, draw = without_frames("GPR")

if __name__ == "__main__":
    present(__file__, main, draw)
