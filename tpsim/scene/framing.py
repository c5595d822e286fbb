"""From where all of something is seen."""

import numpy as np

from tpsim.scene.camera import Camera, upright

SIDEWAYS, UP, DOWN = 1.5, 0.92, 0.74
"""Part of a picture in which films show arms, in halves of its height: above the caption."""

STEPS = 20
"""Of a camera to where it sees all, at most."""


def framed(camera: Camera, points: np.ndarray, around: float, *, filled: bool = False) -> Camera:
    """The camera, aside and back as far as it must be to see points (k, 3), and around them [m].

    Where they are to fill the picture, as near as it may be, with them in the middle.
    """
    high = np.tan(np.radians(camera.fovy) / 2)
    least, most = high * np.array([-SIDEWAYS, -DOWN]), high * np.array([SIDEWAYS, UP])
    place, target = np.array(camera.position), np.array(camera.target)
    right, up, back = upright(place - target)
    axes = np.array([right, up])
    for _ in range(STEPS):
        depth = (place - points) @ back
        seen = (points - place) @ axes.T / depth[:, None]
        room = around / depth[:, None]
        lowest, highest = (seen - room).min(0), (seen + room).max(0)
        wide = float(((highest - lowest) / (most - least)).max())
        aside = np.maximum(highest - most, 0.0) - np.maximum(least - lowest, 0.0)
        if filled:
            aside = (lowest + highest - least - most) / 2
        elif wide <= 1 and not aside.any():
            break
        place = place + depth.mean() * aside @ axes
        if wide > 1 or filled:
            place = place + (wide - 1) * (depth.min() if filled else depth.mean()) * back
    moved = place - np.array(camera.position)
    target = target + moved - (moved @ back) * back
    return Camera(tuple(place.tolist()), tuple(target.tolist()), camera.fovy)
