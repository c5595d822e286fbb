"""Elements of a spec, removed with all that refers to them."""

from collections.abc import Iterator

import mujoco

from tpsim.robot.home import keyframe
from tpsim.robot.kinematic_chain import objects

Names = set[tuple[mujoco.mjtObj, str]]
"""Elements by kind and name."""


def drives_joint(actuator: mujoco.MjsActuator) -> bool:
    """Whether an actuator acts on a joint, not on a tendon, site or body."""
    on_joint = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
    return actuator.trntype in on_joint


def remove_tendon(spec: mujoco.MjSpec, tendon: mujoco.MjsTendon) -> list[str]:
    """Remove a tendon with the actuators, equalities and sensors that need it; say so."""
    name = tendon.name
    gone: Names = {(mujoco.mjtObj.mjOBJ_TENDON, name)}
    changes = [f"tendon '{name}': removed"]
    for actuator in list(spec.actuators):
        if actuator.trntype == mujoco.mjtTrn.mjTRN_TENDON and actuator.target == name:
            gone.add((mujoco.mjtObj.mjOBJ_ACTUATOR, actuator.name))
            changes.append(f"actuator '{actuator.name}' of tendon '{name}': removed")
            spec.delete(actuator)
    for equality in list(spec.equalities):
        is_tendons = equality.type == mujoco.mjtEq.mjEQ_TENDON
        if is_tendons and name in (equality.name1, equality.name2):
            spec.delete(equality)
    spec.delete(tendon)
    return changes + remove_references(spec, gone)


def remove_actuator(spec: mujoco.MjSpec, actuator: mujoco.MjsActuator) -> list[str]:
    """Remove an actuator with the sensors and tuples that name it; say so of these."""
    gone: Names = {(mujoco.mjtObj.mjOBJ_ACTUATOR, actuator.name)}
    spec.delete(actuator)
    return remove_references(spec, gone)


def remove_references(spec: mujoco.MjSpec, gone: Names) -> list[str]:
    """Remove sensors and tuples that name elements which are gone; say so."""
    changes = []
    for sensor in list(spec.sensors):
        named = {(sensor.objtype, sensor.objname), (sensor.reftype, sensor.refname)}
        if named & gone:
            changes.append(f"sensor '{sensor.name}' of '{sensor.objname}': removed")
            spec.delete(sensor)
    for element in list(spec.tuples):
        if gone & set(zip(element.objtype, element.objname, strict=True)):
            changes.append(f"tuple '{element.name}': removed")
            spec.delete(element)
    return changes


def remove_idle(spec: mujoco.MjSpec, model: mujoco.MjModel) -> list[str]:
    """Remove spatial tendons and loops between bodies that no joint moves against each other."""
    changes = []
    for i, tendon in enumerate(list(spec.tendons)):
        bodies = list(_wrapped_bodies(model, i))
        if bodies and len(set(model.body_weldid[bodies])) == 1:
            changes += remove_tendon(spec, tendon)
    loops = (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD)
    for e, equality in enumerate(list(spec.equalities)):
        if int(model.eq_type[e]) in loops and len({*_tied_bodies(model, e)}) == 1:
            changes.append(f"{equality.type.name[7:].lower()} equality of rigid parts: removed")
            spec.delete(equality)
    return changes


def drop_keyframes(spec: mujoco.MjSpec, model: mujoco.MjModel) -> list[str]:
    """Remove the keyframes, which do not fit other scenes, and say which one is home."""
    if not spec.keys:
        return []
    for element in list(spec.keys):
        spec.delete(element)
    key = keyframe(model)
    home = "none is home" if key is None else f"'{model.key(key).name}' is home"
    return [f"keyframes: removed; {home}"]


def drop_gravity_compensation(spec: mujoco.MjSpec, model: mujoco.MjModel) -> list[str]:
    """Let gravity act on the whole robot: its controller compensates it."""
    free = objects(model)
    compensated = [body for body in spec.bodies if body.gravcomp and body.id not in free]
    for body in compensated:
        body.gravcomp = 0
    return [f"gravity compensation of {len(compensated)} bodies: removed"] if compensated else []


def _tied_bodies(model: mujoco.MjModel, equality: int) -> Iterator[int]:
    """Yield the weld root of both bodies of a connect or weld equality."""
    by_site = model.eq_objtype[equality] == mujoco.mjtObj.mjOBJ_SITE
    for ids in (model.eq_obj1id, model.eq_obj2id):
        number = int(ids[equality])
        yield int(model.body_weldid[model.site_bodyid[number] if by_site else number])


def _wrapped_bodies(model: mujoco.MjModel, tendon: int) -> Iterator[int]:
    """Yield the bodies that a spatial tendon touches."""
    first = int(model.tendon_adr[tendon])
    for w in range(first, first + int(model.tendon_num[tendon])):
        kind, number = int(model.wrap_type[w]), int(model.wrap_objid[w])
        if kind == mujoco.mjtWrap.mjWRAP_SITE:
            yield int(model.site_bodyid[number])
        elif kind in (mujoco.mjtWrap.mjWRAP_SPHERE, mujoco.mjtWrap.mjWRAP_CYLINDER):
            yield int(model.geom_bodyid[number])
