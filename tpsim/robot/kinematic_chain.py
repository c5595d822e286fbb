"""The arms of a robot: the joints between the world and its hands."""

from collections.abc import Mapping

import mujoco

from tpsim.errors import ArgumentError

_HINGE_OR_SLIDE = (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)


def arm_joints(model: mujoco.MjModel, hands: Mapping[str, str]) -> tuple[str, ...]:
    """Return the joints between the world and each hand, in model order, each once.

    Parameters
    ----------
    model : MjModel
        The compiled robot.
    hands : mapping of str to str
        Site of each hand by the hand's name.

    Raises
    ------
    ArgumentError
        If there are no hands, a hand is no site, no joint moves it, its base is free, or one of
        the joints is neither hinge nor slide or follows another one.
    """
    sites = _listed(model, "site", model.nsite)
    if hands and not isinstance(hands, Mapping):
        raise ArgumentError(
            f"hands is {hands!r}: name a site for each hand, hands={{'hand': 'site'}}"
        )
    if not hands:
        raise ArgumentError(
            "hands is empty: name a site for each hand, hands={'hand': 'site'}; the robot's sites "
            f"are {sites}"
        )
    ids: set[int] = set()
    for hand, site in hands.items():
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, site)
        if number < 0:
            raise ArgumentError(
                f"hand '{hand}' is at '{site}', which is no site; the sites are {sites}"
            )
        chain = joints_above(model, int(model.site_bodyid[number]))
        if not chain:
            raise ArgumentError(
                f"no joint moves hand '{hand}' at site '{site}'; the robot's joints are "
                f"{_listed(model, 'joint', model.njnt)}"
            )
        ids.update(chain)
    _check_kinds(model, ids)
    _check_independent(model, ids)
    return tuple(model.joint(j).name for j in sorted(ids))


def arm_bodies(model: mujoco.MjModel, hands: Mapping[str, str]) -> set[int]:
    """Return the bodies between the world and each hand, with the world (0)."""
    found = {0}
    for site in hands.values():
        body = int(model.site_bodyid[model.site(site).id])
        while body:
            found.add(body)
            body = int(model.body_parentid[body])
    return found


def objects(model: mujoco.MjModel) -> set[int]:
    """Return the bodies that are free or mocap, and those that they carry."""
    found: set[int] = set()
    for body in range(1, model.nbody):
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        kinds = model.jnt_type[first : first + count] if count else ()
        free = mujoco.mjtJoint.mjJNT_FREE in kinds
        if free or model.body_mocapid[body] >= 0 or int(model.body_parentid[body]) in found:
            found.add(body)
    return found


def joints_above(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the ids of the joints between a body and the world.

    Raises
    ------
    ArgumentError
        If a mocap body carries them.
    """
    chain: list[int] = []
    while body:
        if model.body_mocapid[body] >= 0:
            raise ArgumentError(
                f"body '{model.body(body).name}' carries the arm but is a mocap body: "
                "fix the robot's base to the world"
            )
        if count := int(model.body_jntnum[body]):
            first = int(model.body_jntadr[body])
            chain.extend(range(first, first + count))
        body = int(model.body_parentid[body])
    return chain


def _check_kinds(model: mujoco.MjModel, joints: set[int]) -> None:
    for j in sorted(joints):
        kind = mujoco.mjtJoint(int(model.jnt_type[j]))
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            raise ArgumentError(
                f"the robot's base is free (joint '{model.joint(j).name}'): fix it to the world"
            )
        if kind not in _HINGE_OR_SLIDE:
            raise ArgumentError(
                f"joint '{model.joint(j).name}' of the arm is a ball joint; an arm has hinges and "
                "slides"
            )


def _check_independent(model: mujoco.MjModel, joints: set[int]) -> None:
    """Refuse arm joints that an equality ties to each other."""
    for e in range(model.neq):
        pair = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
        if model.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT and joints.issuperset(pair):
            follower, leader = (model.joint(j).name for j in pair)
            raise ArgumentError(
                f"arm joint '{follower}' follows arm joint '{leader}' by an equality; each joint "
                "of an arm must move on its own"
            )


def _listed(model: mujoco.MjModel, kind: str, count: int) -> str:
    names = [getattr(model, kind)(i).name for i in range(count)]
    return ", ".join(name for name in names if name) or "none"
