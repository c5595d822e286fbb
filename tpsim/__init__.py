"""tpsim: task-parameterized movement learning on simulated torque-controlled robots.

The mathematics of S. Calinon, "A Tutorial on Task-Parameterized Movement Learning and
Retrieval" (2016), re-exported flat. Simulation lives in :mod:`tpsim.sim` and above and is
imported where it is used, so that this import needs numpy and scipy alone.
"""

from tpsim.control.impedance import impedance as impedance
from tpsim.control.impedance import impedance_of as impedance_of
from tpsim.control.planar import PlanarChain as PlanarChain
from tpsim.control.planar import two_armed as two_armed
from tpsim.demonstration import Demonstration as Demonstration
from tpsim.errors import TpsimError as TpsimError
from tpsim.frame import Frame as Frame
from tpsim.gaussian import Gaussian as Gaussian
from tpsim.gaussian import add_ridge as add_ridge
from tpsim.gaussian import floor_eigenvalues as floor_eigenvalues
from tpsim.gaussian import gaussian_product as gaussian_product
from tpsim.gaussian import match_moments as match_moments
