"""The scene in the page: robot and objects, hands that pull, and what is drawn over them."""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field

import mujoco
import numpy as np
import viser
from mjviser import ViserMujocoScene
from mjviser.conversions import merge_geoms

from tpsim import rotation
from tpsim.film.camera import SHOWN, look
from tpsim.film.marks import BLUE, Ellipsoid, Ellipsoids, Forces
from tpsim.play.session import Session
from tpsim.world.impedance import Impedance, hand_stiffness
from tpsim.world.world import World

GHOST = (90, 110, 200)

Grabbed = Callable[[int, int, str, np.ndarray, np.ndarray], None]
"""Told client, body, phase of the drag, point that was taken (3,), and where it is wanted (3,)."""


@dataclass(frozen=True)
class Picture:
    """What there is to see at one moment, copied so that time can go on."""

    xpos: np.ndarray
    xmat: np.ndarray
    mocap: tuple[np.ndarray, np.ndarray]
    pulls: list[tuple[np.ndarray, np.ndarray]]
    beside: tuple[np.ndarray, np.ndarray] | None
    stiffness: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)

    @classmethod
    def of(cls, session: Session, stiffness: bool = False) -> "Picture":
        """What a session looks like now; its lock must be held."""
        going = session.going
        data = going.episode.simulation.data
        pulls = []
        for pull in session.pulls.values():
            drag = pull.drag
            pulls.append((drag.point.copy(), drag.wrench[:3].copy()))
        beside = None
        if session.beside is not None:
            other = session.beside.episode.simulation.data
            beside = other.xpos.copy(), other.xmat.copy()
        found = []
        if stiffness and isinstance(going.command, Impedance):
            state = going.state
            for site in session.world.robot.hands.values():
                K = hand_stiffness(state.jacobian(site), going.command.stiffness)[:3, :3]
                found.append((state.pose(site).position.copy(), K))
        mocap = data.mocap_pos.copy(), data.mocap_quat.copy()
        return cls(data.xpos.copy(), data.xmat.copy(), mocap, pulls, beside, found)


class Stage:
    """The 3-D part of a page.

    Parameters
    ----------
    server : viser.ViserServer
    world : World
    grabbed : callable
        Told when somebody drags a body.
    """

    def __init__(self, server: viser.ViserServer, world: World, grabbed: Grabbed):
        self._server, self._model = server, copy(world.model)
        self._data = mujoco.MjData(self._model)
        self._scene = ViserMujocoScene(server, self._model, 1)
        self._scene.camera_tracking_enabled = False
        # Site balls of hands would hide what they hold.
        self._scene.site_groups_visible = [False] * 6
        self._scene._sync_visibilities()
        server.scene.configure_environment_map(environment_intensity=0.35)
        server.scene.world_axes.visible = False
        look(server.initial_camera, world)
        for group in self._scene._mesh_groups:
            self._listen(group.handle, group.body_ids, grabbed)
        self._forces = Forces(server)
        self._ellipsoids = Ellipsoids(server, "/over/stiffness", BLUE, 0.35)
        self._ghost: _Ghost | None = None

    @staticmethod
    def _listen(handle, bodies: np.ndarray, grabbed: Grabbed) -> None:  # type: ignore[no-untyped-def]
        # Coroutines are called in order: a start never comes after its end.
        @handle.on_drag
        async def _(event) -> None:  # type: ignore[no-untyped-def]
            body = int(bodies[event.instance_index or 0])
            here, wanted = np.array(event.start_position), np.array(event.end_position)
            grabbed(event.client_id, body, event.phase, here, wanted)

    def draw(self, picture: Picture, stiffness: bool = False) -> None:
        """Show a picture to all who watch; its stiffness, where somebody looked at it."""
        data = self._data
        data.xpos[:], data.xmat[:] = picture.xpos, picture.xmat
        data.mocap_pos[:], data.mocap_quat[:] = picture.mocap
        with self._server.atomic():
            self._scene.update_from_mjdata(data)
            self._forces.draw(picture.pulls)
            if stiffness:
                self._ellipsoids.draw([Ellipsoid.of_stiffness(*each) for each in picture.stiffness])
            if picture.beside is not None and self._ghost is None:
                self._ghost = _Ghost(self._server, self._model)
            if self._ghost is not None:
                self._ghost.draw(picture.beside)


class _Ghost:
    """The robot of another controller, seen through."""

    def __init__(self, server: viser.ViserServer, model: mujoco.MjModel):
        self._parts = []
        for body in range(model.nbody):
            geoms = [
                geom
                for geom in range(model.ngeom)
                if model.geom_bodyid[geom] == body and model.geom_group[geom] <= SHOWN
            ]
            if geoms and model.body_weldid[body] and model.body_mocapid[body] < 0:
                mesh = merge_geoms(model, geoms)
                handle = server.scene.add_mesh_simple(
                    f"/ghost/{body}",
                    mesh.vertices,
                    mesh.faces,
                    color=GHOST,
                    opacity=0.25,
                    cast_shadow=False,
                    receive_shadow=False,
                )
                self._parts.append((body, handle))

    def draw(self, poses: tuple[np.ndarray, np.ndarray] | None) -> None:
        for body, handle in self._parts:
            handle.visible = poses is not None
            if poses is not None:
                handle.position = poses[0][body]
                handle.wxyz = rotation.to_quaternion(poses[1][body].reshape(3, 3))
