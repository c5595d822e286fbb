"""What is drawn over a scene: force arrows, traces, stiffness ellipsoids, captions, readings."""

from collections.abc import Sequence

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from tpsim.film.clip import Clip, Reading

_ARROW = (0.95, 0.50, 0.08, 1.0)
_TRACES = ((0.10, 0.45, 0.62, 1.0), (0.80, 0.22, 0.24, 1.0), (0.30, 0.55, 0.25, 1.0))
_ELLIPSOID = (0.16, 0.52, 0.72, 0.32)
_DARK = (24, 28, 34)
_BEYOND = (255, 140, 120)
_METRES_PER_NEWTON = 0.011
_GAP = 0.04  # m between the tip of an arrow and its point
_SMALLEST_FORCE = 0.1  # N that is shown
_SEGMENTS = 150  # of a trace, so that its cost does not grow with its length
_AXIS = 0.09  # m for 500 N/m
_SMALLEST, _LARGEST = 0.008, 0.16  # m, of a semi-axis


def arrow(scene: mujoco.MjvScene, point: np.ndarray, force: np.ndarray) -> None:
    """Draw a force (3,) N whose tip points at ``point (3,)``, from just outside of the hand."""
    size = np.linalg.norm(force)
    if size < _SMALLEST_FORCE:
        return
    geom = _new(scene, mujoco.mjtGeom.mjGEOM_ARROW, _ARROW)
    tip = point - _GAP * force / size
    tail = tip - _METRES_PER_NEWTON * force
    mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_ARROW, 0.011, tail, tip)


def trace(scene: mujoco.MjvScene, path: np.ndarray, colour: int) -> None:
    """Draw a path (T, 3) as a line that fades into the past."""
    path = path[:: max(1, len(path) // _SEGMENTS)]
    for i in range(len(path) - 1):
        *rgb, _ = _TRACES[colour % len(_TRACES)]
        age = 1 - (i + 1) / len(path)
        geom = _new(scene, mujoco.mjtGeom.mjGEOM_LINE, (*rgb, 1 - 0.75 * age))
        geom.emission = 0.6
        mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_LINE, 4, path[i], path[i + 1])


def ellipsoid(scene: mujoco.MjvScene, centre: np.ndarray, stiffness: np.ndarray) -> None:
    """Draw a stiffness (3, 3) N/m; a semi-axis is proportional to the root of its eigenvalue."""
    axes, size = stiffness_axes(stiffness)
    geom = _new(scene, mujoco.mjtGeom.mjGEOM_ELLIPSOID, _ELLIPSOID)
    geom.size[:] = size
    geom.pos[:] = centre
    geom.mat[:] = axes


def stiffness_axes(stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Axes (3, 3) in the columns and semi-axes (3,) [m] of the ellipsoid of a stiffness (3, 3)."""
    values, axes = np.linalg.eigh((stiffness + stiffness.T) / 2)
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    return axes, np.clip(_AXIS * np.sqrt(np.maximum(values, 0) / 500), _SMALLEST, _LARGEST)


def _new(scene: mujoco.MjvScene, kind: mujoco.mjtGeom, rgba: tuple[float, ...]) -> mujoco.MjvGeom:
    """Return a fresh geom at the end of the scene."""
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(
        geom, kind, np.ones(3), np.zeros(3), np.eye(3).ravel(), np.array(rgba, np.float32)
    )
    geom.category = mujoco.mjtCatBit.mjCAT_DECOR
    scene.ngeom += 1
    return geom


class Caption:
    """A bar at the foot of the picture: title, subtitle, the clock and the force that acts."""

    def __init__(self, title: str, subtitle: str, width: int, height: int):
        unit = height / 720
        self.bar = round(60 * unit)
        self._width = width
        self._margin = round(28 * unit)
        self._font = _font("DejaVuSans.ttf", 19 * unit)
        self._image = Image.new("RGB", (width, self.bar), _DARK)
        pen = ImageDraw.Draw(self._image)
        bold = _font("DejaVuSans-Bold.ttf", 22 * unit)
        middle = self.bar // 2
        pen.text((self._margin, middle), title, "white", bold, anchor="lm")
        after = self._margin + pen.textlength(title, bold) + round(18 * unit)
        pen.text((after, middle + 1), subtitle, (176, 184, 194), self._font, anchor="lm")

    def draw(self, picture: np.ndarray, time: float, force: float) -> None:
        """Draw the bar into ``picture (height, width, 3)``: ``time`` s, ``force`` N if any."""
        image = self._image.copy()
        pen = ImageDraw.Draw(image)
        right, middle = float(self._width - self._margin), self.bar // 2
        pen.text((right, middle), f"{time:5.1f} s", (176, 184, 194), self._font, anchor="rm")
        if force >= _SMALLEST_FORCE:
            right -= pen.textlength("000.0 s", self._font) + self._margin
            colour = tuple(round(255 * c) for c in _ARROW[:3])
            pen.text((right, middle), f"force {force:.0f} N", colour, self._font, anchor="rm")
        below = picture[-self.bar :]
        below[:] = (0.12 * below + 0.88 * np.asarray(image)).astype(np.uint8)


class Readings:
    """Figures in the upper left corner, each as it is measured."""

    def __init__(self, readings: Sequence[Reading], height: int):
        unit = height / 720
        self._readings, self._margin, self._line = readings, round(20 * unit), round(30 * unit)
        self._font = _font("DejaVuSans-Bold.ttf", 20 * unit)

    def draw(self, picture: np.ndarray, sample: int) -> None:
        """Draw them into ``picture (height, width, 3)``."""
        lines = []
        for reading in self._readings:
            value = reading.values[sample]
            beyond = reading.limit is not None and value > reading.limit
            text = f"{reading.name} {value:.1f} {reading.unit}".rstrip()
            lines.append((text, _BEYOND if beyond else "white"))
        _lines(picture, lines, self._font, self._line, self._margin, left=True)


class Legend:
    """What is drawn, and to which scale, in the upper right corner."""

    def __init__(self, clip: Clip, height: int):
        unit = height / 720
        self._margin, self._line = round(20 * unit), round(25 * unit)
        self._font = _font("DejaVuSans.ttf", 16 * unit)
        self._lines = [
            (f"\u2014 {name}", _bytes(_TRACES[k % len(_TRACES)]))
            for k, name in enumerate(clip.legend)
        ]
        if clip.ellipsoids:
            scale = f"{100 * _AXIS:.0f} cm for 500 N/m, as its root"
            self._lines.append((f"\u25cf stiffness: half an axis is {scale}", _bytes(_ELLIPSOID)))
        if clip.arrows:
            scale = f"{1000 * _METRES_PER_NEWTON:.0f} cm for 10 N"
            self._lines.append((f"\u2192 a person's force: {scale}", _bytes(_ARROW)))

    def draw(self, picture: np.ndarray) -> None:
        """Draw it into ``picture (height, width, 3)``."""
        _lines(picture, self._lines, self._font, self._line, self._margin, left=False)


def _lines(
    picture: np.ndarray,
    lines: Sequence[tuple[str, str | tuple[int, ...]]],
    font: ImageFont.FreeTypeFont,
    line: int,
    margin: int,
    *,
    left: bool,
) -> None:
    """Write lines of text on a dark field in an upper corner of a picture."""
    if not lines:
        return
    width = max(round(font.getlength(text)) for text, _ in lines) + 2 * margin
    height = line * len(lines) + margin
    x = 0 if left else picture.shape[1] - width
    field = picture[:height, max(x, 0) : max(x, 0) + width]
    image = Image.fromarray((0.3 * field + 0.7 * np.array(_DARK)).astype(np.uint8))
    pen = ImageDraw.Draw(image)
    for k, (text, colour) in enumerate(lines):
        pen.text((margin, margin // 2 + line * (k + 0.5)), text, colour, font, anchor="lm")
    field[:] = np.asarray(image)


def inset(picture: np.ndarray, small: np.ndarray, above: int) -> None:
    """Draw a small picture (h, w, 3) framed in the lower right corner, ``above`` its foot."""
    h, w = small.shape[:2]
    edge = max(2, h // 90)
    foot, right = picture.shape[0] - above - 3 * edge, picture.shape[1] - 3 * edge
    picture[foot - h - edge : foot + edge, right - w - edge : right + edge] = 235
    picture[foot - h : foot, right - w : right] = small


def _bytes(rgba: tuple[float, ...]) -> tuple[int, ...]:
    """Colour for text on a dark field: lighter than in the scene."""
    return tuple(round(255 * (0.35 + 0.65 * part)) for part in rgba[:3])


def _font(name: str, size: float) -> ImageFont.FreeTypeFont:
    """Load one of matplotlib's fonts."""
    from matplotlib import get_data_path

    return ImageFont.truetype(f"{get_data_path()}/fonts/ttf/{name}", round(size))
