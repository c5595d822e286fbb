"""The process that draws: pictures of clips, as RGB bytes on the standard output.

It is started by :mod:`tpsim.film.video` with a ``MUJOCO_GL`` that works, and is told on its
standard input what to draw.
"""

import os
import pickle
import sys

import mujoco
import numpy as np

from tpsim.film import overlay
from tpsim.film.camera import lit, viewpoint
from tpsim.film.clip import Clip
from tpsim.robot.home import put


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
        model.vis.quality.offsamples = antialias
        model.vis.quality.shadowsize = 1536
        if antialias:
            model.vis.quality.shadowsize = 4096
            model.vis.quality.numslices = 48
            model.vis.quality.numstacks = 24
        self._clip = clip
        self._camera = viewpoint(model, clip.camera or camera)
        self._model, self._data = model, mujoco.MjData(model)
        self._joints = [model.joint(name).qposadr[0] for name in clip.world.description.joints]
        self._renderer = mujoco.Renderer(model, height, width)
        self._caption = (
            overlay.Caption(clip.title, clip.subtitle, width, height) if clip.title else None
        )
        self._mocap = {name: model.body(name).mocapid[0] for name in clip.objects}
        put(model, self._data.qpos, clip.world.description.fixed)

    def __enter__(self) -> "Painter":
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Free the renderer."""
        self._renderer.close()

    def picture(self, sample: int) -> np.ndarray:
        """Draw one sample: (height, width, 3) bytes."""
        self._pose(sample)
        self._renderer.update_scene(self._data, self._camera)
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._renderer.scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = True
        self._draw_over(sample)
        picture = self._renderer.render()
        if self._caption:
            forces = [np.linalg.norm(arrow.force[sample]) for arrow in self._clip.arrows]
            self._caption.draw(picture, self._clip.time[sample], float(max(forces, default=0.0)))
        return picture

    def _pose(self, sample: int) -> None:
        clip, data = self._clip, self._data
        data.qpos[self._joints] = clip.q[sample]
        for name, poses in clip.objects.items():
            data.mocap_pos[self._mocap[name]] = poses[sample, :3]
            if poses.shape[1] == 7:
                data.mocap_quat[self._mocap[name]] = poses[sample, 3:]
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


def main() -> None:
    """Draw the job on the standard input; frames come clip by clip."""
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # nothing but pictures may go out
    clips, frames, *settings = pickle.load(sys.stdin.buffer)
    for index, clip in enumerate(clips):
        samples = [sample for i, sample in frames if i == index]
        if samples:
            with Painter(clip, *settings) as painter:
                for sample in samples:
                    out.write(painter.picture(sample).tobytes())
                    out.flush()
