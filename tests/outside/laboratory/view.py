"""A view: how far a site is from an object."""

from dataclasses import dataclass

import numpy as np

from tpsim import lab


@dataclass(frozen=True)
class Distance(lab.View):
    """Distance [m] of a site of the robot from an object, d = 1."""

    site: str
    target: str

    def labels(self, robot):
        return ("distance [m]",)

    def see(self, state):
        target = state.objects[self.target]
        way = state.pose(self.site).position - target.position
        distance = np.linalg.norm(way)
        towards = way / distance
        J = towards @ state.jacobian(self.site)[:3]
        return lab.Seen(np.array([distance]), J[None], np.array([-towards @ target.velocity]))
