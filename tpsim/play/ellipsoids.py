"""Ellipsoids in the page, of which the number may change."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import viser

from tpsim import rotation


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid: centre (3,) [m], axes (3, 3) in the columns, semi-axes (3,) [m]."""

    centre: np.ndarray
    axes: np.ndarray
    size: np.ndarray


class Ellipsoids:
    """Several ellipsoids, of which the number may change."""

    def __init__(
        self, server: viser.ViserServer, name: str, colour: tuple[int, int, int], opacity: float
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


def _ball() -> tuple[np.ndarray, np.ndarray]:
    import trimesh  # comes with viser

    ball = trimesh.creation.icosphere(subdivisions=2)
    return ball.vertices, ball.faces
