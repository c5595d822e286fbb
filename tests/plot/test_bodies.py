import numpy as np
from matplotlib.figure import Figure

from tpsim import PlanarChain, plot


def test_an_arm_is_drawn_through_its_joints_from_light_to_dark():
    (axis,) = plot.panels(Figure())
    chain, q = PlanarChain((0.5, 0.4)), np.array([[0.1, 0.2], [0.5, -0.3], [0.7, 1.0]])
    plot.arm(axis, chain, q, label="arm")
    *links, base = axis.lines
    for line, posture in zip(links, q, strict=True):
        np.testing.assert_allclose(line.get_xydata(), chain.points(posture))
    assert links[-1].get_color() == plot.INK
    assert [line.get_label() for line in links if line.get_label() == "arm"] == ["arm"]
    np.testing.assert_array_equal(base.get_xydata(), [[0, 0]])


def test_bones_connect_joints():
    (axis,) = plot.panels(Figure())
    joints = np.array([[0, 0], [0, 1], [1, 1.0]])
    plot.skeleton(axis, joints, [(0, 1), (1, 2)], label="figure")
    drawn = [line.get_xydata().tolist() for line in axis.lines]
    assert drawn == [[[0, 0], [0, 1]], [[0, 1], [1, 1]]]


def test_a_band_is_one_standard_deviation_wide():
    (axis,) = plot.panels(Figure(), kind="curve")
    plot.band(axis, [0, 1], [1, 2], [0.5, 0.1])
    y = axis.collections[0].get_paths()[0].vertices
    assert {0.5, 1.5, 1.9, 2.1} <= set(np.round(y[:, 1], 9))


def test_a_matrix_is_white_at_zero():
    (axis,) = plot.panels(Figure())
    plot.matrix(axis, [[0.0, 2.0], [-1.0, 0.0]])
    (image,) = axis.images
    assert image.get_clim() == (-2.0, 2.0)
    assert np.round(image.cmap(image.norm(0.0))[:3], 1).min() > 0.9
