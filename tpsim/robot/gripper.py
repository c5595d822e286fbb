"""Where a hand grips, on a robot whose file has no site there."""

from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np

from tpsim.border import Point, checked
from tpsim.errors import ArgumentError


@dataclass(frozen=True)
class Gripper:
    """A frame between the fingers: z is where the hand reaches to, y across the fingers.

    Parameters
    ----------
    at : str
        A site or a body of the robot's file, on which the frame is.
    position : (3,) tuple
        Of the frame's origin, in coordinates of ``at`` [m].
    reach, across : (3,) tuples
        The frame's z and y axes there, which are orthogonal; of any length.
    """

    at: str
    position: Point = (0.0, 0.0, 0.0)
    reach: Point = (0.0, 0.0, 1.0)
    across: Point = (0.0, 1.0, 0.0)

    def __post_init__(self) -> None:
        checked(self)
        z, y = np.array(self.reach), np.array(self.across)
        lengths = float(np.linalg.norm(z) * np.linalg.norm(y))
        if not lengths or abs(z @ y) > 1e-6 * lengths:
            raise ArgumentError(
                f"reach {self.reach} and across {self.across} of a gripper: give two axes that "
                "are orthogonal and not zero"
            )

    @property
    def rotation(self) -> np.ndarray:
        """Of the frame (3, 3), in coordinates of ``at``."""
        z, y = (np.array(v) / np.linalg.norm(v) for v in (self.reach, self.across))
        return np.stack([np.cross(y, z), y, z], axis=1)


def add_grippers(spec: mujoco.MjSpec, hands: Mapping[str, "str | Gripper"]) -> dict[str, str]:
    """Add a site for every hand that is a gripper, called as the hand.

    Parameters
    ----------
    spec : MjSpec
        The robot, changed in place.
    hands : mapping of str to str or Gripper
        Site of each hand, or where it grips.

    Returns
    -------
    dict of str to str
        Site of each hand.

    Raises
    ------
    ArgumentError
        If a gripper is on neither site nor body, or its name is that of another site.
    """
    sites = {}
    for hand, where in hands.items():
        if isinstance(where, Gripper):
            add_frame(spec, hand, where)
            sites[hand] = hand
        else:
            sites[hand] = where
    return sites


def add_frame(spec: mujoco.MjSpec, name: str, frame: Gripper) -> None:
    """Add a site called ``name`` at a frame; errors are those of :func:`add_grippers`."""
    if spec.site(name) is not None:
        raise ArgumentError(f"the robot has a site '{name}' already: call the hand otherwise")
    site, body = spec.site(frame.at), spec.body(frame.at)
    if site is None and body is None:
        raise ArgumentError(
            f"'{name}' is on '{frame.at}', which is neither site nor body; sites are "
            f"{', '.join(s.name for s in spec.sites) or 'none'}, bodies "
            f"{', '.join(b.name for b in spec.bodies[1:])}"
        )
    position, quaternion = np.array(frame.position), np.empty(4)
    mujoco.mju_mat2Quat(quaternion, frame.rotation.ravel())
    if site is not None:
        body, own = site.parent, np.array(site.quat)
        if site.alt.type != mujoco.mjtOrientation.mjORIENTATION_QUAT:
            own = spec.resolve_orientation(
                degree=spec.compiler.degree, sequence=spec.compiler.eulerseq, orientation=site.alt
            )
        moved, turned = np.empty(3), np.empty(4)
        mujoco.mju_mulPose(moved, turned, site.pos, np.array(own), position, quaternion)
        position, quaternion = moved, turned
    body.add_site(name=name, pos=position, quat=quaternion, group=4)
