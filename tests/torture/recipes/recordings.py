"""Good calls of ``tpsim.data`` and ``tpsim.plot``: recordings and pictures."""

import os
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from recipe import Book, Made

from tpsim import Demonstration, Frame, Gaussian, PlanarChain, data, plot

FOLDER = Path(tempfile.mkdtemp(prefix="torture-"))
T = 30
TIME = np.linspace(0.0, 1.0, T)
MOVE = np.clip(2 * TIME - 0.5, 0.0, 1.0)
PATH = np.column_stack([MOVE, MOVE**2, 0.1 * MOVE])
DEMONSTRATIONS = [
    Demonstration(TIME, PATH + 0.1 * k, Frame(np.eye(3), [0.1 * k, 0.0, 0.0]), name=f"d{k}")
    for k in range(3)
]
ONE = DEMONSTRATIONS[0]
COLUMNS = data.Columns(time="time", position=("x", "y", "z"), frames=("box",))
SERIES = data.Series(
    {
        "time": TIME,
        "x": PATH[:, 0],
        "y": PATH[:, 1],
        "z": PATH[:, 2],
        "box_x": TIME,
        "box_y": TIME,
        "box_z": TIME,
    },
    TIME,
)
RECORDING = data.Recording("a file", (SERIES,))
ROWS = "\n".join(",".join(f"{v:.6f}" for v in (t, *p)) for t, p in zip(TIME, PATH, strict=True))
CSV = FOLDER / "one.csv"
CSV.write_text("time,x,y,z\n" + ROWS + "\n")
TRIAL = {"time": TIME, "q": PATH, "hand_position": PATH}
PLANAR = np.column_stack([MOVE, MOVE**2])
GAUSSIAN = Gaussian(PLANAR[:3], 0.1 * np.eye(2))


def book() -> Book:
    """All of them."""
    book = Book()
    _cleaning(book)
    _files(book)
    _pictures(book)
    return book


def _cleaning(book: Book) -> None:
    add = book.add
    add(
        "data.aligned",
        data.aligned,
        words=("time", "rate"),
        demonstrations=DEMONSTRATIONS,
        band=0.2,
        by="data",
    )
    add(
        "data.resampled",
        data.resampled,
        words=("time", "sample", "rate"),
        demonstration=ONE,
        times=None,
        rate=20.0,
        smooth=False,
    )
    add(
        "data.resampled",
        data.resampled,
        words=("time", "sample", "rate"),
        demonstration=ONE,
        times=10,
        smooth=True,
    )
    add("data.smoothed", data.smoothed, words=("sample",), demonstration=ONE, window=0.2, order=3)
    add(
        "data.trimmed",
        data.trimmed,
        words=("columns",),
        demonstration=ONE,
        still=0.05,
        margin=0.1,
        window=0.1,
        columns=[0, 1],
    )
    add(
        "data.segmented",
        data.segmented,
        words=("pieces", "sample"),
        demonstration=ONE,
        at="stops",
        pause=0.1,
        still=0.05,
        window=0.1,
        columns=[0],
    )
    add(
        "data.segmented",
        data.segmented,
        words=("pieces", "sample"),
        demonstration=ONE,
        at="changes",
        pieces=2,
    )
    add("data.segmented", data.segmented, words=("pieces", "sample"), demonstration=ONE, at=[0.5])


def _files(book: Book) -> None:
    add = book.add
    add(
        "data.Columns",
        data.Columns,
        time="time",
        rate=None,
        time_unit="s",
        position=("x", "y", "z"),
        orientation=None,
        order=None,
        joints="q",
        other=None,
        length_unit="m",
        angle_unit="rad",
        frames=("box",),
        moving=False,
        demonstration=None,
        bad_rows="refuse",
    )
    add("data.Columns", data.Columns, rate=10.0)
    add("data.Columns.over", COLUMNS.over, defaults=data.Columns(length_unit="mm"))
    add(
        "data.PoseColumns",
        data.PoseColumns,
        name="box",
        position=("x", "y", "z"),
        orientation=(),
        order="wxyz",
        moving=False,
    )
    add(
        "data.Series",
        data.Series,
        columns=dict(SERIES.columns),
        time=TIME,
        units={"x": "m"},
        first_line=2,
        keeps=("columns", "time"),
        infinite=True,
        takes={"columns": {"*"}, "time": {"*"}},
    )
    add("data.Series.names_of", SERIES.names_of, name="x")
    add("data.Series.values", SERIES.values, name="x")
    add("data.Series.rows", SERIES.rows, keep=np.arange(5))
    add(
        "data.Recording",
        data.Recording,
        source="f",
        series=(SERIES,),
        name="n",
        format="csv",
        defaults=COLUMNS,
        clock=False,
    )
    for method in ("find", "has", "known"):
        add(f"data.Recording.{method}", getattr(RECORDING, method), words=("column",), name="x")
    add(
        "data.frames_from",
        data.frames_from,
        words=("arrays",),
        recording=RECORDING,
        columns=COLUMNS,
    )
    add("data.poses_in", data.poses_in, recording=RECORDING)
    add(
        "data.read",
        data.read,
        words=("file",),
        path=str(CSV),
        columns=data.Columns(position=("x", "y", "z")),
        format="text",
    )
    add("data.recordings", data.recordings, words=("file",), path=str(CSV), format="text")
    for write, ending in (("write_csv", "csv"), ("write_lerobot", ""), ("write_mcap", "mcap"),
                          ("write_robomimic", "hdf5")):  # fmt: skip
        add(
            f"data.{write}",
            _in_new_folder(getattr(data, write)),
            words=("demonstration", "trial", "write", "exists", "new folder", "d1", "fps"),
            path=Made(lambda e=ending: _new(e)),
            items=[ONE] if write != "write_robomimic" else DEMONSTRATIONS,
        )
    add(
        "data.write_csv",
        _in_new_folder(data.write_csv),
        words=("demonstration", "trial", "write", "exists", "d1", "fps"),
        path=Made(lambda: _new("csv")),
        items=[TRIAL],
    )
    add(
        "data.write",
        _in_new_folder(data.write),
        words=("demonstration", "trial", "ends with", "write", "exists", "d1", "fps"),
        path=Made(lambda: _new("npz")),
        items=[ONE],
    )


def _in_new_folder(write):
    """Relative names are names in a folder of their own."""

    def call(**given):
        before = Path.cwd()
        os.chdir(tempfile.mkdtemp(dir=FOLDER))
        try:
            return write(**given)
        finally:
            os.chdir(before)

    return call


def _new(ending: str) -> str:
    folder = Path(tempfile.mkdtemp(dir=FOLDER))
    return str(folder / f"new.{ending}" if ending else folder / "new")


def _pictures(book: Book) -> None:
    add = book.add
    axis = Made(lambda: Figure().add_subplot())
    word = {"colour": "#0072B2", "label": "l"}
    add("plot.arm", plot.arm, axis=axis, chain=PlanarChain([1.0, 0.5]), postures=PLANAR[:3], **word)
    add(
        "plot.skeleton",
        plot.skeleton,
        axis=axis,
        joints=PLANAR[:3],
        bones=[(0, 1), (1, 2)],
        width=1.8,
        **word,
    )
    add(
        "plot.band",
        plot.band,
        words=("mean", "deviation"),
        axis=axis,
        x=TIME,
        mean=MOVE,
        deviation=TIME,
        **word,
    )
    add("plot.matrix", plot.matrix, axis=axis, values=np.eye(3))
    add("plot.demonstrations", plot.demonstrations, axis=axis, paths=[ONE, PLANAR], **word)
    add("plot.ellipses", plot.ellipses, axis=axis, gaussian=GAUSSIAN, fill=0.25, **word)
    add("plot.tube", plot.tube, axis=axis, path=GAUSSIAN, **word)
    add("plot.points", plot.points, axis=axis, places=PLANAR[:3], marker="o", **word)
    add(
        "plot.frames",
        plot.frames,
        words=("size", "frame"),
        axis=axis,
        frames=[Frame(np.eye(2), np.zeros(2))],
        colours=["#009E73"],
        size=1.0,
        labels=["a"],
    )
    add("plot.legend", plot.legend, figure=Made(_figure), columns=5)
    add(
        "plot.panels",
        plot.panels,
        figure=Made(Figure),
        rows=1,
        columns=2,
        kind="plane",
        size=(3.2, 2.9),
    )
    add("plot.same_view", plot.same_view, axes=Made(lambda: [_figure().axes[0]]), margin=0.06)
    add("plot.save", plot.save, figure=Made(_figure), path=Made(lambda: _new("png")), dpi=20)
    add("plot.shades", plot.shades, colour="#0072B2", count=3, lightest=0.75)
    add("plot.title", plot.title, axis=axis, text="t")


def _figure() -> Figure:
    figure = Figure(figsize=(1, 1))
    figure.add_subplot().plot([0, 1], [0, 1], label="a")
    return figure
