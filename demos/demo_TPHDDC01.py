"""demo_TPHDDC01: a task-parameterized mixture in subspaces (Section 4.1).

Look for: the ellipses of demo_TPGMM01: in the plane, one eigenvector and one variance outside it
are a full covariance (Eqs 9-10).
"""

from _tp_mixture import tp_mixture

from tpsim import HDDC
from tpsim.gallery import present

main, draw = tp_mixture(HDDC(1), parameters=32)

if __name__ == "__main__":
    present(__file__, main, draw)
