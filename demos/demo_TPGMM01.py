"""demo_TPGMM01: a task-parameterized Gaussian mixture (Section 3, Figs 2 and 4).

Look for: narrow ellipses at the start in the first frame and at the end in the second; in a new
situation, components that lie at the objects wherever these are (Eqs 5-6).
"""

from _tp_mixture import tp_mixture

from tpsim.gallery import present

main, draw = tp_mixture("full", parameters=32)

if __name__ == "__main__":
    present(__file__, main, draw)
