"""Two dancers in a waltz hold, made from a rhythm: 31 joints each, positions in space.

The leader's hips go along a box step and turn; the feet step in turn; the partner faces the leader,
steps as in a mirror, and the hands meet. What varies between dances is the size of the steps, how
fast the couple turns, where the dance goes and how far the two stand apart.
"""

from dataclasses import dataclass

import numpy as np

SAMPLES, DURATION = 100, 4.0
TIME = np.linspace(0.0, DURATION, SAMPLES)

LEG, FOOT, ARM, HAND = (0.43, 0.43), (0.15, 0.07), (0.30, 0.26), (0.08, 0.08, 0.05)
SPINE = (0.12, 0.14, 0.14, 0.1, 0.08, 0.14)  # up to the head [m]
HIP, SHOULDER, HEIGHT = 0.1, 0.18, 0.88

BONES = (
    *((i, i + 1) for i in (0, 1, 2, 3, 4)),
    *((0 if i == 5 else i, i + 1) for i in (5, 6, 7, 8, 9)),
    *((0 if i == 10 else i, i + 1) for i in (10, 11, 12, 13, 14, 15)),
    *((13 if i == 16 else i, i + 1) for i in (16, 17, 18, 19, 20, 21)),
    (20, 23),
    *((13 if i == 23 else i, i + 1) for i in (23, 24, 25, 26, 27, 28)),
    (27, 30),
)
"""Joints that a bone connects: two legs, spine and head, two arms."""


@dataclass(frozen=True)
class Dance:
    """What a dance looks like.

    Parameters
    ----------
    step : float
        Size of the box [m].
    turn : float
        Turning rate [rad/s].
    heading : float
        Direction at the start [rad].
    apart : float
        Distance between the two [m].
    """

    step: float = 0.4
    turn: float = 0.4
    heading: float = 0.0
    apart: float = 0.5

    @classmethod
    def drawn(cls, rng: np.random.Generator, spread: float = 1.0) -> "Dance":
        """Draw a dance; ``spread`` 1 is the range of the demonstrations."""
        draw = spread * rng.uniform(-1, 1, 4)
        return cls(0.4 + 0.12 * draw[0], 0.4 * draw[1], np.pi * draw[2], 0.5 + 0.04 * draw[3])

    def dancers(self) -> tuple[np.ndarray, np.ndarray]:
        """Joints of leader and partner, each (T, 31, 3) [m]."""
        beat = 2 * np.pi * TIME / DURATION * 2
        R = turned(self.heading + self.turn * TIME)
        box = np.stack([np.sin(beat / 2), 0.5 * np.sin(beat), 0.03 * np.cos(2 * beat)], 1)
        hips = self.step * box @ turned(np.array(self.heading)).T + [0, 0, HEIGHT]
        ahead = np.array([self.apart, 0.0, 0.0])
        half = np.diag([-1.0, -1.0, 1.0])  # the partner looks the other way
        other, R_other = hips + _apply(R, ahead), R @ half
        swing = 0.5 * self.step * np.sin(beat)
        sway = 0.06 * np.sin(beat + 0.5)
        clasp = hips + _apply(R, ahead / 2 + [0, 0.45, 0.42])
        back = hips + _apply(R, ahead + np.array([0.08, -0.16, 0.38]))
        shoulder = hips + _apply(R, np.array([0.0, -SHOULDER, 0.52]))
        leader = _body(hips, R, swing, beat, 0.3 * sway, clasp, back)
        partner = _body(other, R_other, swing, beat, sway, shoulder, clasp)
        return leader, partner


def heading_of(joints: np.ndarray) -> np.ndarray:
    """Heading of a dancer (T,) [rad], seen from the hips."""
    across = joints[:, 1] - joints[:, 6]
    return np.arctan2(-across[:, 0], across[:, 1])


def bones_of(joints: np.ndarray) -> np.ndarray:
    """Lengths of all bones (T, 30) [m]."""
    return np.stack([np.linalg.norm(joints[:, a] - joints[:, b], axis=1) for a, b in BONES], 1)


def _body(hips, R, swing, beat, sway, left, right) -> np.ndarray:
    """Joints (T, 31, 3) from hips, heading, steps, and where the two hands are."""
    joints = [hips]
    for side in (1, -1):
        hip = hips + _apply(R, np.array([0.0, side * HIP, -0.04]))
        lift = 0.06 * np.maximum(0.0, side * np.cos(beat))
        ankle = _apply(R, np.stack([side * swing, side * HIP + 0 * swing, 0 * swing], 1))
        ankle = np.c_[(hips + ankle)[:, :2], 0.08 + lift]
        joints += [hip, *_limb(hip, ankle, LEG, _apply(R, np.array([1.0, 0.0, 0.0])))]
        joints += [ankle + _apply(R, np.array([FOOT[0], 0.0, -0.05]))]
        joints += [joints[-1] + _apply(R, np.array([FOOT[1], 0.0, 0.0]))]
    up = _apply(R, np.stack([0 * sway, np.sin(sway), np.cos(sway)], 1))
    for length in SPINE:
        joints.append(joints[-1 if len(joints) > 11 else 0] + length * up)
    for side, target in ((1, left), (-1, right)):
        shoulder = joints[13] + _apply(R, np.array([0.0, side * SHOULDER, 0.04]))
        out = _apply(R, np.array([-0.3, side * 0.5, -1.0]))
        elbow, wrist = _limb(shoulder, target, ARM, out)
        along = (wrist - elbow) / ARM[1]
        fingers = [wrist + reach * along for reach in np.cumsum(HAND)]
        thumb = wrist + 0.05 * along + _apply(R, np.array([0.0, 0.0, 0.04]))
        joints += [shoulder, elbow, wrist, *fingers, thumb]
    return np.stack(joints, axis=1)


def _limb(root, target, lengths, pole) -> tuple[np.ndarray, np.ndarray]:
    """Middle joint and end of two links that reach for a target, bent towards the pole."""
    way = target - root
    reach = np.linalg.norm(way, axis=1, keepdims=True)
    near = np.minimum(reach, 0.995 * sum(lengths))
    along = way / reach
    foot = (near**2 + lengths[0] ** 2 - lengths[1] ** 2) / (2 * near)
    side = pole - (pole * along).sum(1, keepdims=True) * along
    side = side / np.linalg.norm(side, axis=1, keepdims=True)
    bend = np.sqrt(np.maximum(lengths[0] ** 2 - foot**2, 0.0))
    return root + foot * along + bend * side, root + near * along


def turned(angle: np.ndarray) -> np.ndarray:
    """Rotations about the vertical (..., 3, 3)."""
    c, s, o = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    rows = (c, -s, o), (s, c, o), (o, o, o + 1)
    return np.stack([np.stack(row, -1) for row in rows], -2)


def _apply(R: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.einsum("tij,...j->ti" if x.ndim == 1 else "tij,tj->ti", R, x)
