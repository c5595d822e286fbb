"""The page of the planar example: two objects to drag, ellipses and movements that follow."""

import threading
import time

import numpy as np
import viser

from tpsim.film.marks import Ellipsoid, Ellipsoids
from tpsim.frame import Frame
from tpsim.gaussian import Gaussian
from tpsim.play.plane import OFFERED, Plane, tube
from tpsim.plot.style import PALETTE
from tpsim.section8.method import Path

RATE = 25.0
"""Updates per second while something moves."""

FLAT = 0.004
"""Half height of an ellipse [m]."""

GREY = (150, 150, 155)
WALL = ((-0.25, 0.6), (-0.25, -0.1), (0.25, -0.1), (0.25, 0.6))
"""Corners of a U in its frame [m]."""

TEXT = (
    "**Drag the two objects** by their arrows, turn them by the arc. Thin lines are the "
    "demonstrations, ellipses the TP-GMM in these frames, bands one standard deviation."
)


class PlanePage:
    """One page of the planar example.

    Parameters
    ----------
    server : viser.ViserServer
    plane : Plane

    Attributes
    ----------
    updates : int
        So far.
    took : float
        Time [s] of the last one.
    """

    def __init__(self, server: viser.ViserServer, plane: Plane):
        self.server, self.plane = server, plane
        self.updates, self.took = 0, 0.0
        self._lock, self._moved, self._ended = threading.Lock(), threading.Event(), False
        gui, camera = server.gui, server.initial_camera
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.main_panel.dock_right()
        camera.position, camera.look_at = (0.0, -0.01, 4.6), (0.0, 0.0, 0.0)
        camera.fov = 0.75
        server.scene.world_axes.visible = False
        server.scene.add_grid("/ground", 8, 8, plane="xy", position=(0, 0, -0.02))
        gui.add_markdown(TEXT)
        self._boxes = {}
        with gui.add_folder("Methods"):
            for name in OFFERED:
                box = gui.add_checkbox(name, name in plane.methods)
                box.on_update(self._choose)
                self._boxes[name] = box
        self._count = gui.add_slider("Demonstrations", 2, 8, 1, len(plane.demonstrations))
        self._components = gui.add_slider("Components", 1, 8, 1, plane.model.components)
        for slider in (self._count, self._components):
            slider.on_update(self._learn)
        self._rate = gui.add_markdown("")
        self._gizmos = [self._gizmo(k, frame) for k, frame in enumerate(plane.frames)]
        self._ellipses = Ellipsoids(server, "/components", (213, 94, 0), 0.35)
        self._lines: dict[str, viser.LineSegmentsHandle] = {}
        self._demonstrations: list[viser.LineSegmentsHandle] = []
        self._show_demonstrations()
        self._painter = threading.Thread(target=self._paint, name="tpsim page", daemon=True)
        self._moved.set()
        self._painter.start()

    def is_alive(self) -> bool:
        """Whether it still draws."""
        return self._painter.is_alive()

    def close(self) -> None:
        """Stop drawing."""
        self._ended = True
        self._moved.set()
        self._painter.join()

    def _gizmo(self, index: int, frame: Frame) -> viser.TransformControlsHandle:
        angle = float(np.arctan2(frame.A[1, 0], frame.A[0, 0]))
        gizmo = self.server.scene.add_transform_controls(
            f"/object{index}",
            0.35,
            active_axes=(True, True, False),
            depth_test=False,
            position=(*frame.b, 0.0),
            wxyz=(np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)),
        )
        wall = np.array([(*corner, 0.0) for corner in WALL])
        self.server.scene.add_line_segments(
            f"/object{index}/wall",
            np.stack([wall[:-1], wall[1:]], axis=1),
            (30, 40, 60),
            thickness=5,
            thickness_units="screen",
        )

        @gizmo.on_update
        async def _(event: object) -> None:
            w, _, _, z = gizmo.wxyz
            with self._lock:
                self.plane.move(index, gizmo.position[:2], 2 * float(np.arctan2(z, w)))
            self._moved.set()

        return gizmo

    def _choose(self, event: object) -> None:
        chosen = [name for name, box in self._boxes.items() if box.value]
        with self._lock:
            self.plane.choose(chosen)
        self._moved.set()

    def _learn(self, event: object) -> None:
        with self._lock:
            self.plane.learn(int(self._count.value), int(self._components.value))
        self._show_demonstrations()
        self._moved.set()

    def _paint(self) -> None:
        while not self._ended:
            self._moved.wait()
            self._moved.clear()
            begun = time.monotonic()
            with self._lock:
                situation = self.plane.retrieve()
            with self.server.atomic():
                self._ellipses.draw(list(_flat(situation.components)))
                for k, (name, path) in enumerate(situation.paths.items()):
                    self._line(name, path, PALETTE[k % len(PALETTE)])
                for name in self._lines.keys() - _names(situation.paths):
                    self._lines.pop(name).remove()
            self.updates, self.took = self.updates + 1, time.monotonic() - begun
            if self.updates % 5 == 1:
                self._rate.content = f"{1000 * self.took:.0f} ms an update"
            time.sleep(max(0.0, 1 / RATE - self.took))

    def _line(self, name: str, path: Path, colour: str) -> None:
        red, green, blue = bytes.fromhex(colour[1:])
        if not isinstance(path, Gaussian):
            self._draw(name, [path], (red, green, blue), 4.0)
            return
        self._draw(name, [path.mean], (red, green, blue), 4.0)
        self._draw(f"{name} edges", list(tube(path)), (red, green, blue), 1.0)

    def _draw(
        self, name: str, paths: list[np.ndarray], colour: tuple[int, int, int], thickness: float
    ) -> None:
        """Lines of one name; their points change, the lines stay."""
        flat = [np.column_stack([path, np.full(len(path), 0.01)]) for path in paths]
        points = np.concatenate([np.stack([p[:-1], p[1:]], axis=1) for p in flat])
        known = self._lines.get(name)
        if known is None or known.points.shape != points.shape:
            self._lines[name] = self.server.scene.add_line_segments(
                f"/paths/{name}", points, colour, thickness=thickness, thickness_units="screen"
            )
        else:
            known.points = points.astype(np.float32)

    def _show_demonstrations(self) -> None:
        for line in self._demonstrations:
            line.remove()
        self._demonstrations = []
        for k, demonstration in enumerate(self.plane.demonstrations):
            x = np.column_stack([demonstration.data[:, :2], np.zeros(len(demonstration.data))])
            self._demonstrations.append(
                self.server.scene.add_line_segments(
                    f"/shown/{k}",
                    np.stack([x[:-1], x[1:]], axis=1),
                    GREY,
                    thickness=1.5,
                    thickness_units="screen",
                )
            )


def _names(paths: dict[str, Path]) -> set[str]:
    return {*paths, *(f"{name} edges" for name in paths)}


def _flat(components: Gaussian):  # type: ignore[no-untyped-def]
    """Ellipses of one deviation, as flat ellipsoids."""
    for mean, covariance in zip(components.mean, components.covariance, strict=True):
        values, vectors = np.linalg.eigh(covariance)
        axes = np.eye(3)
        axes[:2, :2] = vectors
        yield Ellipsoid(np.array([*mean, 0.0]), axes, np.array([*np.sqrt(values), FLAT]))
