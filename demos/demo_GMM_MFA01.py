"""demo_GMM_MFA01: mixture of factor analysers (Section 4.2, Eqs 11 and 57-63).

Look for: 51 parameters where full covariances have 59: one direction, and for every variable a
noise of its own, which buys back half of the likelihood that HDDC gives away.
"""

from _subspace import subspaces

from tpsim import MFA
from tpsim.gallery import present

main, draw = subspaces("MFA", MFA(1), parameters=51)

if __name__ == "__main__":
    present(__file__, main, draw)
