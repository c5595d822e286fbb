"""How hands and joints move at large: the reference against which a frame matters (Section 9)."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tpsim.learning.effective import effective_samples
from tpsim.learning.free_movement import relevance
from tpsim.learning.tp_gmm import TPGMM
from tpsim.robot.robot import Robot
from tpsim.robot.views.observe import observe
from tpsim.robot.views.view import View
from tpsim.world.trial import Trial

DRAWS = 400
"""Exchanges drawn to see how a view varies when its parts move independently."""

LEAST = {"position": 0.03, "angle": 0.15, "posture": 0.15}
"""Standard deviation [m, rad] that free movement has at least: of demonstrations that are all alike
nothing is irrelevant."""

STRIDE = 5
"""Of the recorded samples every fifth is looked at: neighbours say the same."""


def with_relevance(
    robot: Robot,
    models: Mapping[str, TPGMM],
    views: Mapping[str, Mapping[str, View]],
    taught: Mapping[str, Sequence[Trial]],
) -> dict[str, TPGMM]:
    """The models of a task with what matters in their frames.

    Free movement is learned from all demonstrations of all behaviours:

    - A view of one thing alone, such as a hand in the base, would vary in every direction as much
      as the most varied direction of its kind (position, angle, posture) in any view of the task.
    - A view of several things that move on their own (arms, objects) would vary as it does when
      these are exchanged between demonstrations and times. What is left beyond is what this frame
      adds to the others.

    Models with inputs, such as time, are returned as they are.

    Parameters
    ----------
    robot : Robot
    models : mapping of str to TPGMM
    views : mapping of str to mapping of str to View
        Those of every model's frames.
    taught : mapping of str to sequence of Trial
    """
    timed = {
        name
        for name, model in models.items()
        if [view.manifold(robot).dim for view in views[name].values()] != list(model.dims)
    }
    seen = {
        name: [_seen(robot, list(views[name].values()), trial) for trial in taught[name]]
        for name in models
        if name not in timed
    }
    widest = _widest(robot, views, seen)
    found = dict(models)
    for name, trials in seen.items():
        exchanged = _exchanged(robot, views[name], taught[name])
        parts = []
        for j, (view, gaussian) in enumerate(
            zip(views[name].values(), models[name].frames, strict=True)
        ):
            kinds = view.kinds(robot)
            least = np.diag([LEAST.get(kind, 0.0) ** 2 for kind in kinds])
            alone = np.diag([widest[kind] ** 2 for kind in kinds])
            free = alone if exchanged[j] is None else exchanged[j] + least
            samples = effective_samples([trial[j] for trial in trials], "covariance")
            share = float(models[name].priors.min())
            parts.append(relevance(gaussian, free, kinds, share * samples))
        found[name] = replace(models[name], relevance=tuple(parts))
    return found


def _seen(robot: Robot, views: list[View], trial: Trial) -> list[np.ndarray]:
    objects = {name: (p[::STRIDE], r[::STRIDE]) for name, (p, r) in trial.objects.items()}
    return observe(robot, views, trial["q"][::STRIDE], objects)


def _widest(
    robot: Robot,
    views: Mapping[str, Mapping[str, View]],
    seen: Mapping[str, list[list[np.ndarray]]],
) -> dict[str, float]:
    """Largest standard deviation of every kind, over all directions, views and behaviours."""
    widest = dict(LEAST)
    for name, trials in seen.items():
        for j, view in enumerate(views[name].values()):
            kinds = np.array(view.kinds(robot))
            covariance = np.atleast_2d(np.cov(np.concatenate([trial[j] for trial in trials]).T))
            for kind in dict.fromkeys(kinds.tolist()):
                own = np.flatnonzero(kinds == kind)
                spread = float(np.linalg.eigvalsh(covariance[np.ix_(own, own)])[-1])
                widest[kind] = max(widest.get(kind, 0.0), float(np.sqrt(max(spread, 0.0))))
    return widest


def _exchanged(
    robot: Robot, views: Mapping[str, View], trials: Sequence[Trial]
) -> list[np.ndarray | None]:
    """Covariance of every view when what it is made of is exchanged; None of one thing alone."""
    rng = np.random.default_rng(0)
    q = np.concatenate([trial["q"][::STRIDE] for trial in trials])
    places = {
        name: tuple(
            np.concatenate([trial.objects[name][k][::STRIDE] for trial in trials]) for k in (0, 1)
        )
        for name in trials[0].objects
    }
    parts: list[np.ndarray | str] = [*independent_joints(robot), *places]
    first, *draws = rng.integers(len(q), size=(len(parts) + 1, DRAWS))

    def look(exchanged: Sequence[int]) -> list[np.ndarray]:
        posture = q[first].copy()
        objects = {name: (p[first].copy(), r[first].copy()) for name, (p, r) in places.items()}
        for k in exchanged:
            part = parts[k]
            if isinstance(part, str):
                objects[part] = tuple(values[draws[k]] for values in places[part])
            else:
                posture[:, part] = q[draws[k]][:, part]
        return observe(robot, list(views.values()), posture, objects)

    alone, others = look([]), [look([k]) for k in range(len(parts))]
    everything = look(range(len(parts)))
    found: list[np.ndarray | None] = []
    for j in range(len(views)):
        moved = sum(not np.array_equal(other[j], alone[j]) for other in others)
        found.append(np.atleast_2d(np.cov(everything[j].T)) if moved > 1 else None)
    return found


def independent_joints(robot: Robot) -> list[np.ndarray]:
    """Indices of the joints, in groups that move the same hands and no others."""
    groups: dict[tuple[bool, ...], list[int]] = {}
    state = robot.at_home
    moves = [np.abs(state.jacobian(site)).max(0) > 0 for site in robot.hands.values()]
    for joint in range(robot.n):
        groups.setdefault(tuple(bool(m[joint]) for m in moves), []).append(joint)
    return [np.array(joints) for joints in groups.values()]
