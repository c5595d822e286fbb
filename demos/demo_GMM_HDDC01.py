"""demo_GMM_HDDC01: clusters in subspaces by eigendecomposition (Section 4.1, Eqs 9-10).

Look for: 39 parameters where full covariances have 59: in every component one direction, and one
variance for all others. The likelihood is the price.
"""

from _subspace import subspaces

from tpsim import HDDC
from tpsim.gallery import present

main, draw = subspaces("HDDC", HDDC(1), parameters=39)

if __name__ == "__main__":
    present(__file__, main, draw)
