"""The process that draws: pictures of clips, as RGB bytes on the standard output.

It is started by :mod:`tpsim.film.video` with a ``MUJOCO_GL`` that works, and is told on its
standard input what to draw.
"""

import os
import pickle
import sys
from contextlib import ExitStack

import mujoco
import numpy as np

from tpsim.film import overlay
from tpsim.film.camera import lit, viewpoint
from tpsim.film.clip import Clip
from tpsim.robot.home import put
from tpsim.world.recorded_place import put_object

_FAST, _FINE = (1024, 20, 10), (4096, 48, 24)
"""Side of the shadow map [pixels], and into how many parts round bodies are cut, round and along:
for films, whose cost they decide where no card draws, and for stills."""

_INSET = 0.36
"""Side of the inset, as a share of the picture's height."""

_NEAR = 0.45
"""Distance [m] of its camera."""

_NEARER = 1.3
"""Distance [m] from the centre of a clip that has one."""


class Painter:
    """Draws the samples of one clip.

    Parameters
    ----------
    clip : Clip
    camera : str
        Camera where the clip names none; if that is empty too, the world's ``hero`` or, without
        one, a camera that sees everything.
    width, height : int
        Size of the pictures, pixels.
    antialias : int
        Samples per pixel; 0 costs least.
    """

    def __init__(self, clip: Clip, camera: str, width: int, height: int, antialias: int):
        model = lit(clip.world)
        model.vis.global_.offwidth = width
        model.vis.global_.offheight = height
        quality = model.vis.quality
        quality.offsamples = antialias
        quality.shadowsize, quality.numslices, quality.numstacks = _FINE if antialias else _FAST
        self._clip = clip
        # A narrow picture shows as wide a piece of the scene as a square one.
        wider = max(1.0, height / width)
        model.cam_fovy[:] = np.degrees(
            2 * np.arctan(wider * np.tan(np.radians(model.cam_fovy) / 2))
        )
        self._camera = viewpoint(model, clip.camera or camera)
        self._model, self._data = model, mujoco.MjData(model)
        self._joints = [model.joint(name).qposadr[0] for name in clip.world.description.joints]
        self._renderer = mujoco.Renderer(model, height, width)
        self._caption = (
            overlay.Caption(clip.title, clip.subtitle, width, height) if clip.title else None
        )
        self._readings = overlay.Readings(clip.readings, height)
        self._legend = overlay.Legend(clip, height) if clip.legend else None
        side = round(_INSET * height)
        self._near = mujoco.Renderer(model, side, side) if clip.close is not None else None
        put(model, self._data.qpos, clip.world.description.fixed)

    def __enter__(self) -> "Painter":
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Free the renderers."""
        self._renderer.close()
        if self._near is not None:
            self._near.close()

    def picture(self, sample: int) -> np.ndarray:
        """Draw one sample: (height, width, 3) bytes."""
        self._pose(sample)
        self._renderer.update_scene(self._data, self._camera)
        eyes = self._renderer.scene.camera
        eye = (eyes[0].pos + eyes[1].pos) / 2
        if self._clip.centre is not None:
            nearer = _towards(self._clip.centre, _NEARER, eye)
            self._renderer.update_scene(self._data, nearer)
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = True
        self._draw_over(sample)
        picture = self._renderer.render()
        if self._near is not None:
            above = self._caption.bar if self._caption else 0
            overlay.inset(picture, self._close_up(sample, eye), above)
        self._readings.draw(picture, sample)
        if self._legend is not None:
            self._legend.draw(picture)
        if self._caption:
            forces = [np.linalg.norm(arrow.force[sample]) for arrow in self._clip.arrows]
            self._caption.draw(picture, self._clip.time[sample], float(max(forces, default=0.0)))
        return picture

    def _close_up(self, sample: int, eye: np.ndarray) -> np.ndarray:
        """The same moment from near, along the same line of sight."""
        assert self._near is not None and self._clip.close is not None
        self._near.update_scene(self._data, _towards(self._clip.close[sample], _NEAR, eye))
        self._near.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        # Four fifths of its cost, for shadows that fall outside it.
        self._near.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        small: np.ndarray = self._near.render()
        return small

    def _pose(self, sample: int) -> None:
        clip, data = self._clip, self._data
        data.qpos[self._joints] = clip.q[sample]
        for name, poses in clip.objects.items():
            put_object(self._model, data, name, poses[sample])
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_comPos(self._model, data)
        mujoco.mj_camlight(self._model, data)

    def _draw_over(self, sample: int) -> None:
        scene = self._renderer.scene
        for colour, path in enumerate(self._clip.traces):
            overlay.trace(scene, path[: sample + 1], colour)
        for shape in self._clip.ellipsoids:
            overlay.ellipsoid(scene, shape.centre[sample], shape.stiffness[sample])
        for arrow in self._clip.arrows:
            overlay.arrow(scene, arrow.point[sample], arrow.force[sample])


def _towards(point: np.ndarray, distance: float, eye: np.ndarray) -> mujoco.MjvCamera:
    """A camera that sees a point from so near, from the direction of an eye."""
    away = point - eye
    camera = mujoco.MjvCamera()
    camera.lookat[:] = point
    camera.distance = distance
    camera.azimuth = np.degrees(np.arctan2(away[1], away[0]))
    camera.elevation = np.degrees(np.arctan2(away[2], np.hypot(*away[:2])))
    return camera


def main() -> None:
    """Draw the job on the standard input; frames come row by row, clips of a row side by side."""
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nothing but pictures may go out
    rows, frames, camera, width, height, antialias = pickle.load(sys.stdin.buffer)
    for index, clips in enumerate(rows):
        samples = [sample for i, sample in frames if i == index]
        edges = [width * k // len(clips) for k in range(len(clips) + 1)]
        if not samples:
            continue
        with ExitStack() as stack:
            painters = [
                stack.enter_context(Painter(clip, camera, right - left, height, antialias))
                for clip, left, right in zip(clips, edges, edges[1:], strict=False)
            ]
            for sample in samples:
                parts = [painter.picture(sample) for painter in painters]
                out.write(np.hstack(parts).tobytes())
                out.flush()
