"""A home posture, found by optimization."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from scipy.optimize import minimize

from tpsim.robot.home import put
from tpsim.robot.kinematic_chain import joints_above

_STARTS = 6
_ITERATIONS = 40
_MARGIN = 0.1  # of a joint's range, at either end
_SPARE = 0.8  # of the torque limit
_ARM_LENGTH = 0.5  # m; makes rotations comparable to translations


def find_home(
    model: mujoco.MjModel,
    joints: Sequence[str],
    hands: Mapping[str, str],
    torque_limit: np.ndarray,
    known: Mapping[str, float],
) -> np.ndarray:
    """Find a posture in the middle of the ranges, away from singularities, at low torque.

    Hand by hand, minimizes from several starts the squared distance from the middle of the joint
    ranges, the squared share of the torque limits that gravity takes, and the logarithm of the
    condition number of the hand's Jacobian. A posture without contacts that leaves torque to
    spare is preferred.

    Parameters
    ----------
    model : MjModel
        The compiled robot.
    joints : sequence of str
        The arm joints, n.
    hands : mapping of str to str
        Site of each hand.
    torque_limit : (n,)
        Torque limits, Nm or N.
    known : mapping of str to float
        Positions that are given: of arm joints, which keep them, and of other joints.

    Returns
    -------
    (n,)
        Joint positions, rad or m.
    """
    data = mujoco.MjData(model)
    free = dict(zip((model.joint(joint).id for joint in joints), torque_limit, strict=True))
    middle, _, _ = _ranges(model, [*free])
    data.qpos[model.jnt_qposadr[[*free]]] = middle
    put(model, data.qpos, known)
    for name in known:
        free.pop(model.joint(name).id, None)
    for site in (model.site(name).id for name in hands.values()):
        chain = sorted(free.keys() & set(joints_above(model, int(model.site_bodyid[site]))))
        if chain:
            limit = np.array([free.pop(joint) for joint in chain])
            _place(_Arm(model, data, site, chain, limit))
    return np.array([data.qpos[model.jnt_qposadr[model.joint(joint).id]] for joint in joints])


def _place(arm: "_Arm") -> None:
    """Put one arm into its best posture."""
    rng = np.random.default_rng(0)
    low, high = arm.middle - arm.inner, arm.middle + arm.inner
    starts = [arm.middle, *rng.uniform(low, high, (_STARTS - 1, len(low)))]
    found = [
        minimize(
            arm.cost,
            start,
            method="L-BFGS-B",
            bounds=np.stack((low, high), axis=1),
            options={"maxiter": _ITERATIONS, "ftol": 1e-5},
        )
        for start in starts
    ]
    best = min(found, key=lambda result: (*arm.defects(result.x), result.fun))
    arm.cost(best.x)


def _ranges(
    model: mujoco.MjModel, joints: Sequence[int]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return middle and half of each joint's range, and whether it is limited, each (n,)."""
    limited = model.jnt_limited[joints].astype(bool)
    slides = model.jnt_type[joints] == mujoco.mjtJoint.mjJNT_SLIDE
    reach = np.where(slides, _ARM_LENGTH, np.pi)
    middle = np.where(
        limited, model.jnt_range[joints].mean(axis=1), model.qpos0[model.jnt_qposadr[joints]]
    )
    half = np.where(limited, np.diff(model.jnt_range[joints])[:, 0] / 2, reach)
    return middle, half, limited


class _Arm:
    """The joints of one hand, and what a good posture of them is."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        site: int,
        joints: Sequence[int],
        torque_limit: np.ndarray,
    ):
        self._model, self._data, self._site = model, data, site
        self._qpos, self._dofs = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._torque_limit = torque_limit
        self.middle, self._half, limited = _ranges(model, joints)
        # Where a joint turns without limits, its middle means little.
        self._weight = np.where(limited, 1, 0.1)
        self.inner = (1 - 2 * _MARGIN) * self._half
        chain = joints_above(model, int(model.site_bodyid[site]))
        self._chain = model.jnt_dofadr[chain]
        self._bias, self._jacobian = np.empty(model.nv), np.empty((6, model.nv))
        self._rank = self._highest_rank()

    def cost(self, q: np.ndarray) -> float:
        """Take over a posture (n,) and judge it."""
        load = self._load(q)
        distance = self._weight * ((q - self.middle) / self._half) ** 2
        values = self._singular_values()
        condition = np.log(values[0] / max(values[self._rank - 1], 1e-6))
        return float(distance.mean() + 4 * (load**2).mean() + 0.1 * condition)

    def defects(self, q: np.ndarray) -> tuple[int, int]:
        """Return the number of joints without torque to spare, and of contacts."""
        load = self._load(q)
        mujoco.mj_collision(self._model, self._data)
        return int((load > _SPARE).sum()), int((self._data.contact.dist < 0).sum())

    def _load(self, q: np.ndarray) -> np.ndarray:
        """Take over a posture; return the share (n,) of each torque limit that holding takes."""
        model, data = self._model, self._data
        data.qpos[self._qpos] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_passive(model, data)
        mujoco.mj_rne(model, data, 0, self._bias)
        return np.abs((self._bias - data.qfrc_passive)[self._dofs]) / self._torque_limit

    def _singular_values(self) -> np.ndarray:
        """Return the singular values of the hand's Jacobian, the largest first."""
        J = self._jacobian
        mujoco.mj_jacSite(self._model, self._data, J[:3], J[3:], self._site)
        scaled = J[:, self._chain] * np.repeat((1, _ARM_LENGTH), 3)[:, None]
        return np.linalg.svd(scaled, compute_uv=False)

    def _highest_rank(self) -> int:
        """Return the rank of the hand's Jacobian away from singularities."""
        rng = np.random.default_rng(1)
        ranks = []
        for q in rng.uniform(
            self.middle - self._half, self.middle + self._half, (5, len(self._half))
        ):
            self._load(q)
            values = self._singular_values()
            ranks.append(int((values > 1e-6 * values[0]).sum()))
        return max(ranks)
