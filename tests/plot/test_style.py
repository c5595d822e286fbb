"""One style: colours that all readers tell apart, panels, legend, files."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from tpsim import plot
from tpsim.errors import ArgumentError

# Machado, Oliveira and Fernandes, "A physiologically-based model for simulation of color vision
# deficiency", IEEE TVCG 2009, full severity; for linear RGB.
VISIONS = {
    "normal": np.eye(3),
    "protanopia": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deuteranopia": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritanopia": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}
RGB_TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)


def linear(colour):
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    """CIE L*a*b* of linear RGB, D65."""
    white = RGB_TO_XYZ.sum(1)
    ratio = RGB_TO_XYZ @ np.clip(rgb, 0, 1) / white
    f = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", VISIONS)
def test_colours_are_told_apart_with_any_vision(vision):
    """A difference of 2.3 is just noticed; thin lines want several times that."""
    seen = [lab(np.array(VISIONS[vision]) @ linear(colour)) for colour in plot.PALETTE]
    assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 15


def test_shades_go_from_light_to_the_colour_itself():
    shades = plot.shades(plot.PALETTE[0], 4)
    lightness = [lab(linear(shade))[0] for shade in shades]
    assert lightness == sorted(lightness, reverse=True)
    np.testing.assert_allclose(to_rgb(shades[-1]), to_rgb(plot.PALETTE[0]), atol=1 / 255)
    assert plot.shades(plot.INK, 1) == [plot.INK]


def test_panels_have_the_size_and_kind_asked_for():
    figure = Figure()
    axes = plot.panels(figure, 2, 2, kind=["plane", "curve"], size=(2.0, 1.5))
    np.testing.assert_allclose(figure.get_size_inches(), [4.0, 3.0])
    assert [axis.get_aspect() for axis in axes] == [1.0, "auto", 1.0, "auto"]
    with pytest.raises(ArgumentError, match="rows is 0"):
        plot.panels(Figure(), 0, 1)


def test_same_view_holds_what_is_drawn_in_every_panel():
    axes = plot.panels(Figure(), 1, 2)
    axes[0].plot([0, 1], [0, 1])
    axes[1].plot([4, 5], [-3, 0])
    plot.same_view(axes)
    assert axes[0].get_xlim() == axes[1].get_xlim()
    assert axes[0].get_xlim()[0] < 0 and axes[0].get_xlim()[1] > 5
    assert axes[0].get_ylim()[0] < -3 and axes[0].get_ylim()[1] > 1


def test_legend_names_every_label_once():
    figure = Figure()
    for axis in plot.panels(figure, 1, 2):
        axis.plot([0, 1], label="one")
        axis.plot([1, 0], label="two")
    plot.legend(figure)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["one", "two"]
    empty = Figure()
    plot.panels(empty)
    plot.legend(empty)
    assert empty.legends == []


def test_a_picture_is_a_png_file_and_nothing_else(tmp_path):
    figure = Figure()
    plot.panels(figure)
    path = plot.save(figure, tmp_path / "new" / "picture.png")
    assert path.read_bytes().startswith(b"\x89PNG")
    assert [file.name for file in path.parent.iterdir()] == ["picture.png"]
    with pytest.raises(ArgumentError, match=r"ends in \.png"):
        plot.save(figure, tmp_path / "picture.svg")
