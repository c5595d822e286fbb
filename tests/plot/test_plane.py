"""What is drawn in the plane lies where the mathematics says."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from tpsim import Frame, Gaussian, plot
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstrations


@pytest.fixture
def axis():
    return plot.panels(Figure())[0]


def outlines(axis):
    return [path.vertices for collection in axis.collections for path in collection.get_paths()]


def test_ellipses_are_at_one_standard_deviation(axis):
    rng = np.random.default_rng(0)
    root = rng.standard_normal((3, 2, 2))
    gaussian = Gaussian(rng.standard_normal((3, 2)), root @ root.mT)
    plot.ellipses(axis, gaussian)
    drawn = outlines(axis)
    assert len(drawn) == 3
    for vertices, mean, precision in zip(drawn, gaussian.mean, gaussian.precision, strict=True):
        gap = vertices - mean
        np.testing.assert_allclose(np.einsum("ni,ij,nj->n", gap, precision, gap), 1, rtol=1e-9)
    low, high = axis.dataLim.get_points()
    assert (low <= np.min(np.concatenate(drawn), 0) + 1e-12).all()
    assert (high >= np.max(np.concatenate(drawn), 0) - 1e-12).all()


def test_a_tube_has_the_mean_and_the_width_of_the_path(axis):
    x = np.linspace(0, 1, 5)
    path = Gaussian(np.c_[x, 0 * x], np.tile(np.diag([1e-4, 0.04]), (5, 1, 1)))
    plot.tube(axis, path, label="path")
    np.testing.assert_array_equal(axis.lines[0].get_xydata(), path.mean)
    heights = [np.ptp(vertices[:, 1]) for vertices in outlines(axis)]
    np.testing.assert_allclose(heights, 0.4, rtol=0.01)
    centres = [vertices[:-1].mean(0)[0] for vertices in outlines(axis)]
    assert np.diff(np.sort(centres)).max() < 0.1  # between steps as well: no notches


def test_a_tube_of_one_step(axis):
    plot.tube(axis, Gaussian(np.zeros((1, 2)), np.eye(2)[None]))
    assert len(outlines(axis)) == 1


def test_a_frame_is_a_u_open_along_its_second_axis(axis):
    angle = 0.5 * np.pi  # the second axis points to -x
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    plot.frames(axis, [Frame(R, [1.0, 2.0])], size=2.0, labels=("object",))
    (line,) = axis.lines
    corners = line.get_xydata()
    np.testing.assert_allclose(corners, [[0.4, 1.6], [1.2, 1.6], [1.2, 2.4], [0.4, 2.4]])
    assert line.get_label() == "object"


def test_demonstrations_and_arrays_are_drawn_alike(axis):
    demonstrations = u_demonstrations(2, samples=10)
    plot.demonstrations(axis, [demonstrations[0], demonstrations[1].data])
    for line, demonstration in zip(axis.lines, demonstrations, strict=True):
        np.testing.assert_array_equal(line.get_xydata(), demonstration.data)


def test_what_is_not_in_the_plane_is_refused_with_a_way_out(axis):
    with pytest.raises(ArgumentError, match=r"dimension 3.*marginal"):
        plot.ellipses(axis, Gaussian(np.zeros(3), np.eye(3)))
    with pytest.raises(ArgumentError, match=r"frame 0.*\(3, 3\)"):
        plot.frames(axis, [Frame(np.eye(3), np.zeros(3))])
