import xml.etree.ElementTree as ElementTree
from itertools import pairwise

import numpy as np
import pytest

from tpsim.errors import ArgumentError
from tpsim.study import canvas, plot
from tpsim.study.condition import Condition
from tpsim.study.record import Records
from tpsim.task.task import Situation
from tpsim.world.trial import Trial


@pytest.fixture
def groups(toy):
    rng = np.random.default_rng(0)
    time = np.arange(100) / 100
    wrench = np.zeros((100, 6))
    wrench[30:61, 0] = 20

    def record():
        trial = Trial({"time": time, "push_wrench": wrench, "tilt": rng.random(100)})
        return Records(toy.task, {}).add(Condition("pushed", Situation(())), trial)

    return {"minimal": [record() for _ in range(3)], "stiff": [record() for _ in range(3)]}


def tilt(trial):
    return trial["tilt"]


def spans(axis):
    """Extents along x of what is shaded."""
    return [patch.get_extents().transformed(axis.transData.inverted()) for patch in axis.patches]


def test_panels_show_every_trial_its_median_the_push_and_the_limit(groups):
    figure = plot.panels(groups, tilt, label="tilt [deg]", limit=5)
    left, right = figure.axes
    assert [axis.get_title(loc="left") for axis in figure.axes] == ["minimal", "stiff"]
    assert (left.get_ylabel(), left.get_xlabel()) == ("tilt [deg]", "time [s]")
    *trials, median, limit = left.lines
    for line, trial in zip(trials, groups["minimal"], strict=True):
        np.testing.assert_array_equal(line.get_ydata(), trial["tilt"])
    middle = np.median([trial["tilt"] for trial in groups["minimal"]], axis=0)
    np.testing.assert_array_equal(median.get_ydata(), middle)
    assert list(limit.get_ydata()) == [5, 5]
    (span,) = spans(left)
    np.testing.assert_allclose([span.x0, span.x1], [0.3, 0.6])
    assert left.get_ylim() == right.get_ylim()
    assert left.get_ylim()[0] == 0 and left.get_ylim()[1] > 5


def test_a_label_keeps_its_colour_in_every_figure(groups):
    firsts = {name: trials[0] for name, trials in groups.items()}
    beside = plot.panels(groups, tilt, label="tilt [deg]")
    one = plot.overlay(firsts, tilt, label="tilt [deg]")
    colours = [axis.lines[0].get_color() for axis in beside.axes]
    assert [line.get_color() for line in one.axes[0].lines] == colours == list(canvas.PALETTE[:2])
    assert one.axes[0].get_legend_handles_labels()[1] == ["minimal", "stiff"]


def test_signals_of_one_trial_may_be_negative(groups):
    trial = groups["stiff"][0]
    figure = plot.signals(
        trial, {"x": tilt, "y": lambda trial: -trial["tilt"]}, label="offset [mm]"
    )
    (axis,) = figure.axes
    np.testing.assert_array_equal(axis.lines[1].get_ydata(), -trial["tilt"])
    assert axis.get_ylim()[0] < -trial["tilt"].max()


def test_paired_bars_stand_beside_each_other():
    values = {"minimal": {"+x": 50.0, "-x": 60.0}, "stiff": {"+x": 10.0}}
    (axis,) = plot.paired_bars(values, label="displacement [mm]", limit=40).axes
    heights = [[bar.get_height() for bar in bars] for bars in axis.containers]
    np.testing.assert_array_equal(heights, [[50, 60], [10, np.nan]])
    edges = [
        (bar.get_x(), bar.get_x() + bar.get_width()) for bars in axis.containers for bar in bars
    ]
    edges.sort()
    assert all(end <= start for (_, end), (start, _) in pairwise(edges))
    assert [label.get_text() for label in axis.get_xticklabels()] == ["+x", "-x"]


def test_strips_show_every_value_and_the_mean():
    values = {"minimal": [1.0, 2.0, 6.0], "stiff": [4.0]}
    (axis,) = plot.strips(values, label="tilt [deg]", limit=5).axes
    dots = [list(points.get_offsets()[:, 0]) for points in axis.collections]
    assert dots == list(values.values())
    assert [line.get_xdata()[0] for line in axis.lines] == [3.0, 4.0, 5.0]


def test_nothing_to_draw_is_said():
    with pytest.raises(ArgumentError, match="nothing to draw"):
        plot.panels({}, tilt, label="tilt [deg]")


def test_svg_is_well_formed_takes_the_ink_of_the_page_and_is_always_the_same(groups):
    def draw():
        return canvas.to_svg(plot.panels(groups, tilt, label="tilt [deg]", limit=5))

    svg = draw()
    assert svg == draw()
    assert ElementTree.fromstring(svg).tag.endswith("svg")
    assert "currentColor" in svg and canvas.INK not in svg


def test_png_has_the_size_asked_for(groups):
    png = canvas.to_png(plot.panels(groups, tilt, label="tilt [deg]"), dpi=100)
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(png[16:20], "big") == 760


def test_no_window_and_no_global_state(groups):
    import sys

    plot.panels(groups, tilt, label="tilt [deg]")
    assert (
        "matplotlib.pyplot" not in sys.modules or not sys.modules["matplotlib.pyplot"].get_fignums()
    )
