"""demo_TPMPPCA01: a task-parameterized mixture of principal component analysers (Section 4.2).

Look for: the ellipses of demo_TPGMM01 from one direction and an isotropic noise (Eqs 64-68).
"""

from _tp_mixture import tp_mixture

from tpsim import MPPCA
from tpsim.gallery import present

main, draw = tp_mixture(MPPCA(1), parameters=32)

if __name__ == "__main__":
    present(__file__, main, draw)
