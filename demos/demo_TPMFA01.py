"""demo_TPMFA01: a task-parameterized mixture of factor analysers (Section 4.2).

Look for: the ellipses of demo_TPGMM01 from one direction per component and frame (Eq. 11).
"""

from _tp_mixture import tp_mixture

from tpsim import MFA
from tpsim.gallery import present

main, draw = tp_mixture(MFA(1), parameters=38)

if __name__ == "__main__":
    present(__file__, main, draw)
