"""tpsim: task-parameterized movement learning on simulated torque-controlled robots.

The mathematics of S. Calinon, "A Tutorial on Task-Parameterized Movement Learning and
Retrieval" (2016), re-exported flat. Simulation lives in :mod:`tpsim.sim` and above and is
imported where it is used, so that this import needs numpy and scipy alone.
"""

from tpsim.control import projection as projection
from tpsim.control.feedback import Feedback as Feedback
from tpsim.control.feedback import Plan as Plan
from tpsim.control.impedance import impedance as impedance
from tpsim.control.impedance import impedance_of as impedance_of
from tpsim.control.lqr import Regulator as Regulator
from tpsim.control.lqr import lqr as lqr
from tpsim.control.lqt import lqt as lqt
from tpsim.control.lqt import lqt_batch as lqt_batch
from tpsim.control.lqt import receding_horizon as receding_horizon
from tpsim.control.planar import PlanarChain as PlanarChain
from tpsim.control.planar import two_armed as two_armed
from tpsim.control.spring import damping_of as damping_of
from tpsim.control.spring import spring_damper as spring_damper
from tpsim.control.system import LinearSystem as LinearSystem
from tpsim.control.system import integrator as integrator
from tpsim.demonstration import Demonstration as Demonstration
from tpsim.errors import TpsimError as TpsimError
from tpsim.frame import Frame as Frame
from tpsim.gaussian import Gaussian as Gaussian
from tpsim.gaussian import add_ridge as add_ridge
from tpsim.gaussian import floor_eigenvalues as floor_eigenvalues
from tpsim.gaussian import gaussian_product as gaussian_product
from tpsim.gaussian import match_moments as match_moments
from tpsim.learning.dtw import Warp as Warp
from tpsim.learning.dtw import align as align
from tpsim.learning.dtw import dtw as dtw
from tpsim.learning.gmm import GMM as GMM
from tpsim.learning.gmm import fit_gmm as fit_gmm
from tpsim.learning.hmm import HMM as HMM
from tpsim.learning.hmm import fit_hmm as fit_hmm
from tpsim.learning.hsmm import HSMM as HSMM
from tpsim.learning.hsmm import fit_hsmm as fit_hsmm
from tpsim.learning.incremental import update_tp_gmm as update_tp_gmm
from tpsim.learning.markov import MarkovChain as MarkovChain
from tpsim.learning.pgmm import PGMM as PGMM
from tpsim.learning.pgmm import fit_pgmm as fit_pgmm
from tpsim.learning.pgmm import task_vector as task_vector
from tpsim.learning.relevance import frame_relevance as frame_relevance
from tpsim.learning.relevance import frame_report as frame_report
from tpsim.learning.relevance import frame_shares as frame_shares
from tpsim.learning.selection import aic as aic
from tpsim.learning.selection import bic as bic
from tpsim.learning.selection import dp_means as dp_means
from tpsim.learning.selection import dp_means_start as dp_means_start
from tpsim.learning.selection import select_model as select_model
from tpsim.learning.semi_markov import SemiMarkovChain as SemiMarkovChain
from tpsim.learning.shrinkage import shrink_directions as shrink_directions
from tpsim.learning.subspace import HDDC as HDDC
from tpsim.learning.subspace import MFA as MFA
from tpsim.learning.subspace import MPPCA as MPPCA
from tpsim.learning.tp_gmm import TPGMM as TPGMM
from tpsim.learning.tp_gmm import fit_tp_gmm as fit_tp_gmm
from tpsim.retrieval.clock import on_one_clock as on_one_clock
from tpsim.retrieval.distribution import TPTrajectoryDistribution as TPTrajectoryDistribution
from tpsim.retrieval.distribution import TrajectoryDistribution as TrajectoryDistribution
from tpsim.retrieval.distribution import (
    fit_tp_trajectory_distribution as fit_tp_trajectory_distribution,
)
from tpsim.retrieval.distribution import fit_trajectory_distribution as fit_trajectory_distribution
from tpsim.retrieval.distribution import fuse_frames as fuse_frames
from tpsim.retrieval.dmp import Motion as Motion
from tpsim.retrieval.dmp import attractor_path as attractor_path
from tpsim.retrieval.dmp import decay as decay
from tpsim.retrieval.dmp import forced_attractor as forced_attractor
from tpsim.retrieval.dmp import forcing_term as forcing_term
from tpsim.retrieval.fit_movement import fit_movement as fit_movement
from tpsim.retrieval.fit_tp_gmr import TPGMR as TPGMR
from tpsim.retrieval.fit_tp_gmr import fit_tp_gmr as fit_tp_gmr
from tpsim.retrieval.fit_tp_trajectory import TPTrajectory as TPTrajectory
from tpsim.retrieval.fit_tp_trajectory import fit_tp_trajectory as fit_tp_trajectory
from tpsim.retrieval.gmr import Regression as Regression
from tpsim.retrieval.gmr import gmr as gmr
from tpsim.retrieval.gmr import gmr_mixture as gmr_mixture
from tpsim.retrieval.gp import GaussianProcess as GaussianProcess
from tpsim.retrieval.gp import SquaredExponential as SquaredExponential
from tpsim.retrieval.gp import fit_gp as fit_gp
from tpsim.retrieval.gp_gmm import fit_gp_gmm as fit_gp_gmm
from tpsim.retrieval.kmp import KMP as KMP
from tpsim.retrieval.lwr import lwr as lwr
from tpsim.retrieval.promp import ProMP as ProMP
from tpsim.retrieval.promp import TPProMP as TPProMP
from tpsim.retrieval.promp import fit_promp as fit_promp
from tpsim.retrieval.promp import fit_tp_promp as fit_tp_promp
from tpsim.retrieval.promp import radial_basis as radial_basis
from tpsim.retrieval.tp_gmr import tp_gmr as tp_gmr
from tpsim.retrieval.trajectory import derivative_operator as derivative_operator
from tpsim.retrieval.trajectory import trajectory as trajectory
from tpsim.retrieval.trajectory import trajectory_of_states as trajectory_of_states
