"""What is drawn over a scene in a browser: forces with their size, and ellipsoids."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tpsim import rotation
from tpsim.film.overlay import stiffness_axes

if TYPE_CHECKING:
    import viser

ORANGE, BLUE = (242, 128, 20), (41, 133, 184)

PER_NEWTON = 0.006
"""Length [m] of an arrow for one newton."""

LEAST_FORCE = 0.2
"""Force [N] that is shown, at least."""


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid: centre (3,) [m], axes (3, 3) in the columns, semi-axes (3,) [m]."""

    centre: np.ndarray
    axes: np.ndarray
    size: np.ndarray

    @classmethod
    def of_stiffness(cls, centre: np.ndarray, K: np.ndarray) -> "Ellipsoid":
        """A stiffness (3, 3) N/m at a point: long where it is stiff."""
        return cls(centre, *stiffness_axes(K))


class Ellipsoids:
    """Several ellipsoids, of which the number may change."""

    def __init__(
        self, server: "viser.ViserServer", name: str, colour: tuple[int, int, int], opacity: float
    ):
        self._server, self._name, self._colour, self._opacity = server, name, colour, opacity
        self._handle: viser.BatchedMeshHandle | None = None
        self._count = 0

    def draw(self, shapes: Sequence[Ellipsoid]) -> None:
        """Show these, and no others."""
        if len(shapes) != self._count:
            if self._handle is not None:
                self._handle.remove()
                self._handle = None
            self._count = len(shapes)
        if not shapes:
            return
        axes = np.array([shape.axes for shape in shapes])
        axes[:, :, 0] *= np.sign(np.linalg.det(axes))[:, None]
        turned = rotation.to_quaternion(axes)
        centres, sizes = (
            np.array([getattr(s, part) for s in shapes]) for part in ("centre", "size")
        )
        if self._handle is None:
            vertices, faces = _ball()
            self._handle = self._server.scene.add_batched_meshes_simple(
                self._name,
                vertices,
                faces,
                turned,
                centres,
                batched_scales=sizes,
                batched_colors=self._colour,
                opacity=self._opacity,
                lod="off",
                cast_shadow=False,
                receive_shadow=False,
            )
        else:
            self._handle.batched_wxyzs = turned
            self._handle.batched_positions = centres
            self._handle.batched_scales = sizes


class Forces:
    """Forces of hands as arrows, with their size in N."""

    def __init__(self, server: "viser.ViserServer"):
        self._server = server
        self._arrows: viser.ArrowsHandle | None = None
        self._labels: list[viser.LabelHandle] = []

    def draw(self, forces: Sequence[tuple[np.ndarray, np.ndarray]]) -> None:
        """Show these, points (3,) [m] and forces (3,) [N], and no others."""
        forces = [each for each in forces if np.linalg.norm(each[1]) > LEAST_FORCE]
        if not forces:
            if self._arrows is not None:
                self._arrows.visible = False
            for label in self._labels:
                label.visible = False
            return
        ends = np.array([[p, p + PER_NEWTON * force] for p, force in forces], np.float32)
        if self._arrows is None:
            self._arrows = self._server.scene.add_arrows(
                "/over/forces",
                ends,
                ORANGE,
                shaft_radius=0.007,
                head_radius=0.018,
                head_length=0.045,
            )
        self._arrows.points, self._arrows.visible = ends, True
        while len(self._labels) < len(forces):
            name = f"/over/newton{len(self._labels)}"
            self._labels.append(self._server.scene.add_label(name, "", depth_test=False))
        for k, label in enumerate(self._labels):
            label.visible = k < len(forces)
            if k < len(forces):
                label.text = f"{np.linalg.norm(forces[k][1]):.0f} N"
                label.position = ends[k, 1]


def _ball() -> tuple[np.ndarray, np.ndarray]:
    import trimesh  # comes with viser

    ball = trimesh.creation.icosphere(subdivisions=2)
    return ball.vertices, ball.faces
