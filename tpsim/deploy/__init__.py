"""Policies: what was learned, in a folder that drives a real arm without a simulator."""

from tpsim.deploy.cartesian import CartesianLimits as CartesianLimits
from tpsim.deploy.policy import Policy as Policy
