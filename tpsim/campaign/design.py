"""Which trial is which: trial i of a campaign, from the campaign and i alone."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, prod
from typing import Any

import numpy as np
from scipy.stats import qmc

from tpsim.campaign.campaign import Campaign
from tpsim.campaign.people import Leads, Pushes, Span, levels_of
from tpsim.errors import ArgumentError
from tpsim.study.condition import Lead
from tpsim.world.people.push import Push

_DRAWS, _CUBE = 8, 9

_BLOCK = 24
"""Trials that are performed and written together, about: half a minute's work at most."""


@dataclass(frozen=True)
class Lesson:
    """What is taught and learned once: a teacher, and fields of the task.

    Parameters
    ----------
    number : int
    teacher : int
        Seed of the demonstrations and of the situations.
    fields : mapping
        Of the task, with the campaign's own.
    """

    number: int
    teacher: int
    fields: Mapping[str, object]


@dataclass(frozen=True)
class Asked:
    """What one trial of a campaign is.

    Parameters
    ----------
    trial : int
        Its number.
    point : int
        Number of what it shares with those that differ in controller and plant alone.
    lesson : Lesson
    situation : int
        Its number; drawn with the teacher's seed.
    fields : mapping
        Fields of the task that are varied without learning.
    controller, plant : str
        By name.
    drawn : mapping
        What people do, by the names of :class:`~tpsim.campaign.people.Pushes` or ``Leads``.
    """

    trial: int
    point: int
    lesson: Lesson
    situation: int
    fields: Mapping[str, object]
    controller: str
    plant: str
    drawn: Mapping[str, Any]

    @property
    def twin(self) -> tuple[object, ...]:
        """What it shares with its undisturbed twin."""
        varied = tuple(sorted(self.fields.items()))
        return self.lesson.number, self.situation, varied, self.controller, self.plant


def asked(campaign: Campaign, trial: int) -> Asked:
    """Trial ``trial`` of a campaign.

    Raises
    ------
    ArgumentError
        If the campaign has no such trial.
    """
    if not 0 <= trial < campaign.trials:
        raise ArgumentError(f"the campaign has no trial {trial}; it has 0 to {campaign.trials - 1}")
    point, pair = divmod(trial, campaign.crossed)
    plant, controller = divmod(pair, len(campaign.controllers))
    rest, k = divmod(point, per_situation(campaign))
    situation, number = divmod(rest, campaign.labs)
    own = lesson(campaign, number)
    drawn = _drawn(campaign, own.teacher, situation, k)
    fields = {name: drawn.pop(name) for name in _performed(campaign)}
    return Asked(
        trial,
        point,
        own,
        situation,
        fields,
        campaign.controllers[controller],
        tuple(campaign.plants)[plant],
        _as_people(drawn),
    )


def lesson(campaign: Campaign, number: int) -> Lesson:
    """Lesson ``number`` of a campaign; the teachers come first."""
    value, teacher = divmod(number, campaign.teachers)
    fields = dict(campaign.fields)
    for name, sweep in reversed(campaign.learned_sweeps.items()):
        value, which = divmod(value, len(sweep.values))
        fields[name] = sweep.values[which]
    return Lesson(number, campaign.seed + teacher, fields)


def per_situation(campaign: Campaign) -> int:
    """Trials of one controller on one plant that share a situation."""
    if campaign.design == "latin hypercube":
        return campaign.repeats
    levels = prod(len(v) for v in _varied(campaign).values() if isinstance(v, tuple))
    return levels * campaign.repeats


def block_size(campaign: Campaign) -> int:
    """Trials that are performed and written together: whole situations where they are small."""
    together = per_situation(campaign) * campaign.crossed
    if together <= 2 * _BLOCK:
        return together * max(1, _BLOCK // together)
    return campaign.crossed * max(1, _BLOCK // campaign.crossed)


def blocks(campaign: Campaign) -> int:
    """Number of blocks."""
    return ceil(campaign.trials / block_size(campaign))


def trials_of(campaign: Campaign, block: int) -> range:
    """Numbers of the trials of a block."""
    size = block_size(campaign)
    return range(block * size, min((block + 1) * size, campaign.trials))


def lessons_of(campaign: Campaign, block: int) -> Iterator[int]:
    """Numbers of the lessons on which a block builds."""
    share = campaign.crossed * per_situation(campaign)
    trials = trials_of(campaign, block)
    seen = range(trials[0] // share, trials[-1] // share + 1)
    yield from sorted({situation % campaign.labs for situation in seen})


def _performed(campaign: Campaign) -> dict[str, tuple | Span]:
    """Sweeps without learning."""
    return {
        name: sweep.span or sweep.values
        for name, sweep in campaign.sweeps.items()
        if not sweep.learn
    }


def _varied(campaign: Campaign) -> dict[str, tuple | Span]:
    """All that varies within a situation, by name."""
    people = {} if campaign.people is None else levels_of(campaign.people)
    return {**_performed(campaign), **people}


def _drawn(campaign: Campaign, seed: int, situation: int, k: int) -> dict[str, Any]:
    """What varies, for one point; the same for every lesson of a teacher's seed."""
    varied, performed = _varied(campaign), _performed(campaign)
    if campaign.design == "latin hypercube":
        row = _cube(campaign, len(varied))[situation * campaign.repeats + k]
        return {name: _at(levels, u) for (name, levels), u in zip(varied.items(), row, strict=True)}
    found: dict[str, Any] = {}
    rest, repeat = divmod(k, campaign.repeats)
    paired = 0  # what people do is the same for every value of a sweep
    for name, levels in reversed(varied.items()):
        if isinstance(levels, tuple):
            rest, which = divmod(rest, len(levels))
            found[name] = levels[which]
            if name not in performed:
                paired = paired * len(levels) + which
    key = (_DRAWS, situation, paired, repeat)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=key))
    for name, levels in varied.items():
        if isinstance(levels, Span):
            found[name] = _at(levels, rng.random())
    return found


def _at(levels: tuple | Span, u: float) -> Any:
    """What a share from [0, 1) of a condition comes to."""
    if isinstance(levels, Span):
        return levels.low + float(u) * (levels.high - levels.low)
    return levels[min(int(u * len(levels)), len(levels) - 1)]


@lru_cache(2)
def _rows(points: int, sides: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_CUBE,)))
    cube: np.ndarray = qmc.LatinHypercube(sides, rng=rng).random(points)
    return cube


def _cube(campaign: Campaign, sides: int) -> np.ndarray:
    """The Latin hypercube (points, sides); lessons share its rows."""
    share = campaign.crossed * campaign.repeats * campaign.labs
    return _rows(ceil(campaign.trials / share) * campaign.repeats, sides, campaign.seed)


def _as_people(drawn: dict[str, Any]) -> dict[str, Any]:
    """Angles become directions, which have length one."""
    found = dict(drawn)
    if "turn" in found:
        turn, height = 2 * np.pi * found.pop("turn"), found.pop("height", 0.0)
        level = np.sqrt(1 - np.square(height))
        found["direction"] = (level * np.cos(turn), level * np.sin(turn), height)
    if "direction" in found:
        way = np.array(found["direction"], float)
        found["direction"] = tuple((way / np.linalg.norm(way)).tolist())
    return found


def push_of(people: Pushes, drawn: Mapping[str, Any], duration: float, hand: str) -> Push:
    """The push of one trial.

    Parameters
    ----------
    people : Pushes
    drawn : mapping
        As in :class:`Asked`.
    duration : float
        Of the trial [s].
    hand : str
        Who is pushed where no body is named.

    Raises
    ------
    ArgumentError
        If it lasts longer than the trial.
    """
    long = float(drawn["duration"])
    size = drawn["impulse"] / long if "impulse" in drawn else drawn["force"]
    force = size * np.array(drawn["direction"])
    return Push(_body(drawn, hand), _point(force), _onset(drawn, long, duration), long)


def lead_of(people: Leads, drawn: Mapping[str, Any], duration: float, hand: str) -> Lead:
    """The lead of one trial, from an origin that is of no account; arguments as ``push_of``."""
    long = float(drawn["duration"])
    travel = drawn["travel"] * np.array(drawn["direction"])
    return Lead(
        _body(drawn, hand),
        (0.0, 0.0, 0.0),
        _point(travel),
        # The twin has to be known to the end, where there is no sample any more.
        _onset(drawn, long + people.rest + 0.02, duration),
        long,
        people.rest,
        people.stiffness,
        people.max_force,
    )


def _body(drawn: Mapping[str, Any], hand: str) -> str:
    return str(drawn.get("body", hand))


def _point(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def _onset(drawn: Mapping[str, Any], long: float, duration: float) -> float:
    """When it begins, to a hundredth of a second."""
    room = duration - long
    onset = drawn["onset"] if "onset" in drawn else drawn["phase"] * max(room, 0.0)
    begin = float(np.floor(100 * onset + 1e-6) / 100)
    if begin + long > duration + 1e-9:
        raise ArgumentError(
            f"somebody pushes or leads from {begin:g} s for {long:g} s, and the trial lasts "
            f"{duration:g} s; give a longer one, or a shorter and earlier push"
        )
    return begin
