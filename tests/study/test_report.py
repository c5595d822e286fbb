import base64
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from tpsim.study import plot
from tpsim.study.measure import Result
from tpsim.study.report import Picture, Section, write_report

VOID = {"meta", "img", "br", "link", "input"}
MEASURES = [
    Result("tilt, largest", "tilt, largest", 3.912, "deg", 5),
    Result("sugar offset", "sugar offset", 16.2, "mm", 15),
    Result("displacement", "displacement", 63.4, "mm", 40, at_least=True),
    Result("diverged", "diverged", 0, "", 0),
    Result("work", "work", None),
]


class Page(HTMLParser):
    """Elements that are open, all attributes seen, all text."""

    def __init__(self, text):
        super().__init__()
        self.open, self.links, self.text = [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.links += [v for k, v in attrs if k in ("src", "href", "xlink:href", "poster")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.links += [v for k, v in attrs if k in ("src", "href", "xlink:href")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


@pytest.fixture
def write(tmp_path):
    def write(**parts):
        path = write_report(
            tmp_path / "report.html", title="Cup & sugar", command="tpsim run cup", **parts
        )
        return path.read_text()

    return write


@pytest.fixture
def section():
    figure = plot.paired_bars({"a": {"+x": 1.0}}, label="displacement [mm]")
    image = np.full((4, 6, 3), 200, np.uint8)
    return Section(
        "Pushes <20 N>",
        "First.\n\nSecond.",
        [Picture(figure, "Bars."), Picture(image, "A frame.")],
        [{"controller": "soft", "work [J]": 1.23456}, {"controller": "stiff", "work [J]": 9}],
    )


def test_a_report_is_one_whole_file(write, section, tmp_path):
    page = Page(write(sections=[section], figures=MEASURES, about={"seed": 0}, lead="Hello."))
    assert page.open == []
    assert all(link.startswith(("data:", "#")) for link in page.links)
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]
    for words in ("Cup & sugar", "Pushes <20 N>", "Second.", "Bars.", "tpsim run cup", "mujoco"):
        assert words in page.text


def test_the_table_judges_every_limit(write):
    text = write(figures=MEASURES)
    rows = [re.sub("<[^>]+>", " ", row).split() for row in re.findall("<tr>.*?</tr>", text)]
    assert rows[1:] == [
        ["tilt,", "largest", "3.91", "deg", "≤", "5", "kept"],
        ["sugar", "offset", "16.2", "mm", "≤", "15", "missed"],
        ["displacement", "63.4", "mm", "≥", "40", "kept"],
        ["diverged", "0", "≤", "0", "kept"],
        ["work", "–"],
    ]
    assert "3 of 4 limits kept" in text


def test_the_film_is_inside_or_its_absence_explained(write, tmp_path):
    film = tmp_path / "film.mp4"
    film.write_bytes(b"\x00\x01film")
    (source,) = Page(write(film=film)).links
    kind, content = source.split(";base64,")
    assert (kind, base64.b64decode(content)) == ("data:video/mp4", film.read_bytes())
    without = write(no_film="Install a renderer: apt-get install x")
    assert "<video" not in without and "apt-get install x" in without
    assert "tpsim doctor" in write()


def test_images_are_embedded_as_png(write, section):
    (image,) = (link for link in Page(write(sections=[section])).links if "png" in link)
    assert base64.b64decode(image.split(",")[1])[:4] == b"\x89PNG"


def test_markup_in_words_stays_words(write):
    text = write(notes=["<script>alert(1)</script>"], figures=[Result("x", "<b>x</b>", 1.0)])
    assert "<script>" not in text and "<b>x</b>" not in text
