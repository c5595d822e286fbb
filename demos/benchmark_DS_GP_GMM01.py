"""benchmark_DS_GP_GMM01: a Gaussian process from task parameters to mixtures (Fig. 14, second row).

Look for: regressing the parameters of a mixture helps near the demonstrations. Far from them the
movement ends outside the object, and as the object turns, its approach does not.
"""

from _benchmark import without_frames

from tpsim.gallery import present

main, draw = without_frames("GPR-GMM")

if __name__ == "__main__":
    present(__file__, main, draw)
