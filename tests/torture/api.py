"""Everything that a user can call, found by looking: a new public name needs a recipe."""

import inspect
import typing
from importlib import import_module

ROOMS = {
    "": "tpsim.mathematics",
    "rotation.": "tpsim.rotation",
    "projection.": "tpsim.control.projection",
    "plot.": "tpsim.plot",
    "data.": "tpsim.data",
    "lab.": "tpsim.lab",
}

FURTHER = {
    "": [
        "tpsim.learning.eigenframes:Eigenframes",
        "tpsim.learning.multilinear:CP",
        "tpsim.learning.multilinear:Tucker",
        "tpsim.learning.redundancy:Redundancy",
        "tpsim.learning.relevance:FrameReport",
        "tpsim.learning.selection:Selection",
        "tpsim.retrieval.gp_gmm:MixtureProcess",
    ],
    "lab.": [
        "tpsim.task.environment:environment",
        "tpsim.task.environment:Environment",
        "tpsim.task.gymnasium:gym_environment",
        "tpsim.task.gymnasium:TaskEnvironment",
        "tpsim.task.performance:Performance",
        "tpsim.robot.views.direction:Direction",
        "tpsim.robot.views.joints:Spare",
        "tpsim.robot.views.sites:Sight",
        "tpsim.robot.views.view:Beneath",
        "tpsim.robot.views.view:Offset",
        "tpsim.robot.views.view:Part",
        "tpsim.robot.objects:Objects",
        "tpsim.world.people.guide:HandPath",
        "tpsim.world.simulation:Simulation",
    ],
}
"""What public functions return, beside what the rooms name."""

KINDS = ("Beneath", "CartesianImpedance", "ComputedTorque", "Direction", "Drag", "FiniteHorizon",
         "FixedImpedance", "Guide", "Handover", "Hold", "Joints", "Lead", "MinimalIntervention",
         "Objects", "Offset", "OnPath", "OperationalSpace", "Part", "Pursuit", "Push",
         "RenewedImpedance", "SemiMarkovTracking", "Spare", "TimedIntervention", "View",
         "Weightless")  # fmt: skip
"""Views, controllers and people."""

INSIDE = {
    **dict.fromkeys(
        ["HDDC.fit", "HDDC.start", "MFA.fit", "MFA.start", "MPPCA.fit", "MPPCA.start",
         "_Analysers.fit", "_Subspace.start"],
        "a step of EM, which hands its own statistics on",
    ),
    **dict.fromkeys(
        [f"{chain}.{step}" for chain in ("MarkovChain", "SemiMarkovChain")
         for step in ("expectation", "maximised", "filtered", "viterbi")],
        "a step of EM, which hands its own densities on; users call those of HMM and HSMM",
    ),
    **dict.fromkeys(
        ["rotation.cross_matrix",
         "lab.Pose.checked", "lab.Robot.posture", "rotation.quaternions", "rotation.warn_of_turns",
         "Manifold.moved", "Manifold.part", "Manifold.points", "TrajectoryDistribution.of"],
        "a check, which takes the name under which a user knows the argument",
    ),
    **dict.fromkeys(
        [f"lab.{kind}.{step}" for step in ("command", "kinds", "labels", "manifold", "product",
         "renew", "resolved", "rows", "see", "along", "moving", "bind") for kind in KINDS],
        "its author writes it, the roll-out calls it at every time step",
    ),
    **dict.fromkeys(
        [f"lab.{name}" for name in ("Impedance", "Impedance.of_modes", "Objects", "Pose", "Robot",
         "Robot.of", "Robot.of_source", "Grip.spends", "Grip.wrench", "Push.level", "Push.wrench",
         "Intervention.optimum", "Intervention.product", "OptimalImpedance.stiffness",
         "Care.at", "HandPath.seen_from", "InverseKinematics.__call__", "Motion", "Spring.matrix",
         "Robot.compute_bias", "Robot.compute_energy", "Robot.compute_gravity",
         "Robot.compute_jacobian", "Robot.compute_torque",
         "Robot.compute_mass",
         "Robot.compute_pose", "Robot.friction_torque",
         "Seen", "Simulation", "Simulation.apply_wrench", "Simulation.see", "Simulation.step",
         "State")],
        "made or called at every time step: holds what it is given, unchecked",
    ),
    **dict.fromkeys(
        ["lab.Error.number", "lab.Expert.__call__",
         *(f"lab.Contest.{step}" for step in ("conditions", "figures", "forces", "led_from",
           "moved", "pushed_in", "standing"))],
        "the run calls it, with records and situations of its own",
    ),
    **dict.fromkeys(
        ["Belief", "Belief.expected", "Passage.log_densities", "Passage.place"],
        "made or called at every time step, unchecked",
    ),
    **dict.fromkeys(
        ["Constraint.over", "LinearSystem.over"],
        "called by tracking, with the numbers of its own problem",
    ),
    "lab.pareto": "takes NaN and infinity for what could not be measured",
    "lab.tune": "takes minutes; its arguments pass the border",
    **dict.fromkeys(
        ["Frame.trusted", "Gaussian.trusted", "GMM.trusted", "Regression.trusted",
         "RiemannianGaussian.trusted_on"],
        "documented as the way around all checks",
    ),
}  # fmt: skip
"""Public by name, called by tpsim alone, with arguments of its own."""


def public_calls() -> dict[str, object]:
    """Functions, classes and methods by name, each once."""
    found: dict[str, object] = {}
    seen: set[object] = set()
    for room, path in ROOMS.items():
        module = import_module(path)
        for name, value in vars(module).items():
            named = room in ("rotation.", "projection.")
            if name[0] == "_" or (named and value.__class__.__name__ != "function"):
                continue
            if named and value.__module__ != path:
                continue
            _add(found, seen, room, name, value)
        for place in FURTHER.get(room, ()):
            path, _, name = place.partition(":")
            _add(found, seen, room, name, getattr(import_module(path), name))
    return {name: call for name, call in found.items() if name not in INSIDE}


def _add(found: dict[str, object], seen: set[object], room: str, name: str, value: object) -> None:
    if not getattr(value, "__module__", "").startswith("tpsim"):
        return
    if inspect.isfunction(value):
        if value not in seen:
            found[f"{room}{name}"] = value
            seen.add(value)
    elif inspect.isclass(value) and not issubclass(value, Exception) and not _protocol(value):
        if value in seen:
            return
        seen.add(value)
        if not inspect.isabstract(value):
            found[f"{room}{name}"] = value
        for key, method in _methods(value):
            if method not in seen:
                seen.add(method)
                found[f"{room}{method.__qualname__.partition('.')[0]}.{key}"] = method


def _protocol(kind: type) -> bool:
    return (
        typing.is_protocol(kind) if hasattr(typing, "is_protocol") else "_is_protocol" in vars(kind)
    )


def _methods(kind: type):
    for key in dir(kind):
        static = inspect.getattr_static(kind, key)
        method = getattr(static, "__func__", static)
        ours = inspect.isfunction(method) and method.__module__.startswith("tpsim")
        asked = key[0] != "_" or key in ("__call__", "__getitem__", "__matmul__")
        takes = ours and len(inspect.signature(method).parameters) > 1
        if asked and takes and not getattr(method, "__isabstractmethod__", False):
            yield key, method
