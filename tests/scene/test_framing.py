"""Cameras that see all of something."""

import numpy as np
import pytest

from tpsim.scene.camera import Camera
from tpsim.scene.framing import DOWN, SIDEWAYS, UP, framed


def seen(camera, points):
    """Points in a picture (k, 2), in halves of its height, to the right and up."""
    place = np.array(camera.position)
    back = place - camera.target
    back /= np.linalg.norm(back)
    right = np.cross((0, 0, 1), back)
    right /= np.linalg.norm(right)
    way = points - place
    across = np.stack((way @ right, way @ np.cross(back, right)), axis=1)
    return across / -(way @ back)[:, None] / np.tan(np.radians(camera.fovy / 2))


@pytest.mark.parametrize("filled", [False, True])
def test_all_is_seen_above_the_caption(filled):
    rng = np.random.default_rng(2)
    for _ in range(20):
        points = rng.uniform(-0.5, 0.5, (6, 3)) + rng.uniform(-1, 1, 3)
        first = Camera((4.0, 2.0, 1.0), tuple(rng.uniform(-0.5, 0.5, 3)), 30.0)
        found = framed(first, points, 0.0 if filled else 0.05, filled=filled)
        low, high = seen(found, points).min(0), seen(found, points).max(0)
        slack = 0.01 if filled else 0.0
        assert (low > np.array([-SIDEWAYS, -DOWN]) - slack).all()
        assert (high < np.array([SIDEWAYS, UP]) + slack).all()
        before = np.subtract(first.position, first.target)
        after = np.subtract(found.position, found.target)
        np.testing.assert_allclose(np.cross(before, after), 0, atol=1e-9)
        if filled:
            sizes = (high - low) / [2 * SIDEWAYS, UP + DOWN]
            assert sizes.max() == pytest.approx(1.0, abs=0.01)


def test_what_is_seen_already_is_seen_from_where_it_was():
    camera = Camera((4.0, 2.0, 1.0), (0.0, 0.0, 0.0), 30.0)
    assert framed(camera, np.zeros((1, 3)), 0.05) == camera
