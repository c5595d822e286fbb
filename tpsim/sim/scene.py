"""Scenes: robots, objects and light, composed from the files of ``models/`` by MjSpec.

Every scene is a text of MJCF. The model that is simulated is compiled from that very text, so the
``scene.xml`` of a run folder repeats it bit for bit.
"""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np

from tpsim.sim.stage import camera, hold, light, place, read, text

FLOOR = -0.93
"""Height of the floor below Baxter's torso frame, m."""

HOME = (
    *(0.77643, 0.48409, -0.91141, 2.06775, -0.10938, 0.33157, -0.67192),
    *(0.49732, -0.90217, 1.1919, 1.40747, -0.61722, 1.47197, 0.00951),
)
"""Both arms before the chest, cup level, sugar 8 cm above the middle of its rim, rad."""

READY = (
    *(-0.08, -1.0, -1.19, 1.94, 0.67, 1.03, -0.5),
    *(0.08, -1.0, 1.19, 1.94, -0.67, 1.03, 0.5),
)
"""Baxter's untucked posture: hands ahead, grippers down, rad."""

PAINTS = ((0.10, 0.33, 0.40), (0.72, 0.42, 0.08), (0.24, 0.42, 0.20))
"""Colours of the objects: teal, ochre, moss."""


def cup_and_sugar() -> str:
    """Return Baxter at its table, a cup in the left gripper, a sugar cube in the right one.

    The cup is held by its handle: its axis is the gripper's x, its handle points along -z of the
    gripper. Sites ``cup`` (middle of the opening, z along the axis) and ``sugar`` (centre) are the
    hands of the task. The keyframe ``home`` is ``HOME``.

    Returns
    -------
    str
        MJCF text.
    """
    spec = _baxter()
    hold(spec, "cup", "left_gripper", position=(0, 0, 0.056), axes=((0, 0, 1), (0, -1, 0)))
    hold(spec, "sugar", "right_gripper", position=(0, 0, 0.006))
    spec.add_key(name="home", qpos=HOME)
    return text(spec)


def baxter(objects: Mapping[str, str] | None = None, held: str | None = None) -> str:
    """Return Baxter at its table, and objects that can be moved.

    Parameters
    ----------
    objects : mapping of str to str, optional
        Name of each object and its model: ``"dock"`` (a U that opens along its y) or
        ``"marker"`` (a puck). They are mocap bodies, moved by ``data.mocap_pos`` and
        ``data.mocap_quat``, and touch nothing. They start on an arc before the robot. The
        keyframe ``home`` is ``READY``.
    held : str, optional
        Model of what is between the fingers of the left gripper, such as ``"sugar"``, or
        ``"beam"`` to see where it points; they are empty by default.

    Returns
    -------
    str
        MJCF text.
    """
    spec = _baxter()
    for i, (name, model) in enumerate((objects or {}).items()):
        angle = np.pi / 6 * (i - (len(objects) - 1) / 2)
        spot = (0.75 * np.cos(angle), -0.75 * np.sin(angle), 0.0)
        place(spec, model, name, spot, PAINTS[i % len(PAINTS)])
    if held is not None:
        hold(spec, held, "left_gripper", position=(0, 0, 0.006))
    spec.add_key(name="home", qpos=READY)
    return text(spec)


def planar3(objects: Sequence[str] = ("first", "second")) -> str:
    """Return the arm of three links in the horizontal plane, and pucks to point at.

    Joints ``joint1``, ``joint2``, ``joint3``; sites of the same names and ``tip``, whose x is the
    direction that the arm points at. Keyframe ``home``.

    Parameters
    ----------
    objects : sequence of str
        Names of mocap bodies, moved by ``data.mocap_pos``.

    Returns
    -------
    str
        MJCF text.
    """
    spec = _planar("planar3", objects, fovy=27)
    spec.add_key(name="home", qpos=(1.8, -0.9, -0.6))
    return text(spec)


def planar5(objects: Sequence[str] = ("left_object", "right_object")) -> str:
    """Return the trunk with two arms of two links in the horizontal plane, and pucks to track.

    Joints ``trunk``, ``left_shoulder``, ``left_elbow``, ``right_shoulder``, ``right_elbow``; sites
    of the same names, ``left_hand`` and ``right_hand``. Keyframe ``home``: the trunk along y, the
    hands ahead of it.

    Parameters
    ----------
    objects : sequence of str
        Names of mocap bodies, moved by ``data.mocap_pos``.

    Returns
    -------
    str
        MJCF text.
    """
    spec = _planar("planar5", objects, fovy=30)
    spec.add_key(name="home", qpos=(np.pi / 2, 0.9, -1.1, -0.9, 1.1))
    return text(spec)


def _baxter() -> mujoco.MjSpec:
    """Return Baxter at its table, lit, with the cameras ``hero``, ``hands`` and ``side``."""
    spec = read("baxter")
    light(spec, FLOOR)
    place(spec, "table", "table", position=(0.7, 0, -0.22))
    camera(spec, "hero", position=(2.4, 1.3, 0.75), target=(0.32, 0.05, 0.2), fovy=30)
    camera(spec, "hands", position=(1.35, 0.6, 0.4), target=(0.55, 0.06, 0.19), fovy=32)
    camera(spec, "side", position=(0.9, 2.9, 0.45), target=(0.35, 0, 0.08), fovy=32)
    return spec


def _planar(name: str, objects: Sequence[str], fovy: float) -> mujoco.MjSpec:
    """Return a planar robot on the floor, pucks on a half circle before it, cameras above."""
    spec = read(name)
    light(spec, -0.06)
    angles = np.linspace(np.pi, 0, len(objects) + 2)[1:-1]
    for i, (marker, angle) in enumerate(zip(objects, angles, strict=True)):
        spot = (0.7 * np.cos(angle), 0.7 * np.sin(angle), -0.054)
        place(spec, "marker", marker, spot, PAINTS[i % len(PAINTS)])
    camera(spec, "hero", position=(0, -0.95, 1.9), target=(0, 0.27, 0), fovy=fovy)
    camera(spec, "top", position=(0, 0.29, 2.5), target=(0, 0.3, 0), fovy=fovy)
    return spec
