"""demo_GMM_MPPCA01: mixture of probabilistic principal component analysers (Eqs 64-68).

Look for: 39 parameters where full covariances have 59: like HDDC, one direction and one noise for
all variables, but found by EM instead of an eigendecomposition.
"""

from _subspace import subspaces

from tpsim import MPPCA
from tpsim.gallery import present

main, draw = subspaces("MPPCA", MPPCA(1), parameters=39)

if __name__ == "__main__":
    present(__file__, main, draw)
