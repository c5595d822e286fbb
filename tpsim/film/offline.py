"""Clips in 3-D for any browser, offline: pages that hold viewer, scene and movement."""

import contextlib
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from tpsim.extras import extra
from tpsim.film.camera import SHOWN, look
from tpsim.film.clip import Clip
from tpsim.film.marks import BLUE, Ellipsoid, Ellipsoids, Forces
from tpsim.robot.home import put
from tpsim.world.world import World

if TYPE_CHECKING:
    import viser

RATE = 25.0
"""Pictures per second."""

MOST = 300
"""Pictures of a clip; longer ones have fewer per second."""

FACES = 1200
"""Triangles of one colour of one body; what has more is simplified."""

GREYS = ((70, 120, 150), (160, 80, 80), (90, 130, 80))
"""Colours of the hands' paths."""

SEGMENTS = 150
"""Lines of a path, at most."""


def pages(clips: Sequence[Clip], faces: int = FACES) -> list[str]:
    """A page of HTML for each clip, which needs nothing else: no server and no network.

    Parameters
    ----------
    clips : sequence of Clip
        All of one world.
    faces : int
        Triangles of one colour of one body, at most.

    Raises
    ------
    RecordingError
        If viser is not installed.
    """
    if not clips:
        return []
    server = quiet_server("127.0.0.1", 0, "tpsim")
    try:
        scene = _Scene(server, clips[0].world, faces)
        return [scene.page(clip) for clip in clips]
    finally:
        server.stop()


def quiet_server(host: str, port: int, label: str) -> "viser.ViserServer":
    """A server of viser that says nothing on the terminal; whoever opens it stops it.

    Raises
    ------
    RecordingError
        If viser is not installed.
    """
    with extra("pages in 3-D", "play"):
        import rich
        import viser
    rich.get_console().quiet = True
    with contextlib.redirect_stdout(io.StringIO()):
        return viser.ViserServer(host, port, label, verbose=False)


class _Scene:
    """Bodies of a world as simple meshes, and what is drawn over them."""

    def __init__(self, server: "viser.ViserServer", world: World, faces: int):
        self._server, self._model = server, world.model
        self._data = mujoco.MjData(self._model)
        self._joints = [self._model.joint(name).qposadr[0] for name in world.description.joints]
        put(self._model, self._data.qpos, world.description.fixed)
        mujoco.mj_kinematics(self._model, self._data)
        # Light stays as the viewer has it: what is set here is set anew at each repetition.
        server.scene.world_axes.visible = False
        look(server.initial_camera, world)
        self._bodies = dict(self._frames(faces))
        self._forces = Forces(server)
        self._ellipsoids = Ellipsoids(server, "/over/stiffness", BLUE, 0.35)

    def page(self, clip: Clip) -> str:
        """All of a clip."""
        end, begin = float(clip.time[-1]), float(clip.time[0])
        rate = min(RATE * clip.speed, MOST / max(end - begin, 1e-3))
        moments = np.arange(begin, end, 1 / rate)
        samples = np.searchsorted(clip.time, moments + 1e-6, side="right") - 1
        paths = [self._path(k, path) for k, path in enumerate(clip.traces)]
        self._draw(clip, int(samples[0]))
        recording = self._server.get_scene_serializer()
        for sample in samples[1:].tolist():
            recording.insert_sleep(1 / rate / clip.speed)
            self._draw(clip, sample)
        recording.insert_sleep(1.0)
        page = recording.as_html()
        for path in paths:
            path.remove()
        return page

    def _frames(self, faces: int):  # type: ignore[no-untyped-def]
        """A frame for each body that is looked at, with its parts."""
        scene, model, data = self._server.scene, self._model, self._data
        for body in range(model.nbody):
            kinds: dict[tuple[float, ...], list[int]] = {}
            for geom in np.flatnonzero(model.geom_bodyid == body).tolist():
                colour = _colour(model, geom)
                if model.geom_group[geom] > SHOWN or colour[3] == 0:
                    continue
                if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
                    scene.add_grid(
                        f"/ground/{geom}",
                        infinite_grid=True,
                        fade_distance=20.0,
                        position=model.geom_pos[geom],
                        wxyz=model.geom_quat[geom],
                    )
                    continue
                kinds.setdefault(colour, []).append(geom)
            if not kinds:
                continue
            name = f"/bodies/{body}"
            yield (
                body,
                scene.add_frame(
                    name, show_axes=False, position=data.xpos[body], wxyz=data.xquat[body]
                ),
            )
            for k, (colour, geoms) in enumerate(kinds.items()):
                red, green, blue = (round(255 * part) for part in colour[:3])
                scene.add_mesh_simple(
                    f"{name}/{k}",
                    *_simple(model, geoms, faces),
                    color=(red, green, blue),
                    opacity=None if colour[3] == 1 else colour[3],
                    # It shall also play where there is no graphics card.
                    cast_shadow=False,
                    receive_shadow=False,
                )

    def _path(self, number: int, path: np.ndarray) -> "viser.LineSegmentsHandle":
        path = path[:: max(1, len(path) // SEGMENTS)]
        return self._server.scene.add_line_segments(
            f"/paths/{number}",
            np.stack([path[:-1], path[1:]], axis=1),
            GREYS[number % len(GREYS)],
            thickness=2.0,
            thickness_units="screen",
        )

    def _draw(self, clip: Clip, sample: int) -> None:
        data, model = self._data, self._model
        data.qpos[self._joints] = clip.q[sample]
        for name, poses in clip.objects.items():
            row = model.body(name).mocapid[0]
            data.mocap_pos[row] = poses[sample, :3]
            if poses.shape[1] == 7:
                data.mocap_quat[row] = poses[sample, 3:]
        mujoco.mj_kinematics(model, data)
        for body, frame in self._bodies.items():
            if np.abs(frame.position - data.xpos[body]).max() > 1e-5:
                frame.position = np.round(data.xpos[body], 5)
            turned = data.xquat[body] * (1 if data.xquat[body] @ frame.wxyz >= 0 else -1)
            if np.abs(frame.wxyz - turned).max() > 1e-5:
                frame.wxyz = np.round(turned, 5)
        self._forces.draw([(arrow.point[sample], arrow.force[sample]) for arrow in clip.arrows])
        self._ellipsoids.draw(
            [
                Ellipsoid.of_stiffness(shape.centre[sample], shape.stiffness[sample])
                for shape in clip.ellipsoids
            ]
        )


def _colour(model: mujoco.MjModel, geom: int) -> tuple[float, ...]:
    material = int(model.geom_matid[geom])
    found = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    return tuple(np.clip(found, 0, 1).tolist())


def _simple(model: mujoco.MjModel, geoms: list[int], faces: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of geoms in their body, no more than so many."""
    with extra("pages in 3-D", "play"):
        import fast_simplification
        from mjviser.conversions import merge_geoms
    mesh = merge_geoms(model, geoms)
    vertices, triangles = np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.int32)
    if len(triangles) > faces:
        vertices, triangles = fast_simplification.simplify(vertices, triangles, target_count=faces)
    return vertices, triangles
