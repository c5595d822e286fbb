"""Films and stills of recorded trials, drawn after the simulation in processes of their own."""

import contextlib
import os
import pickle
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from tpsim.errors import ArgumentError, RenderingError, SimulationError
from tpsim.film import rendering
from tpsim.film.camera import cameras
from tpsim.film.clip import Clip
from tpsim.whole import whole_path

_DRAW = "from tpsim.driver import end_with; end_with({}); from tpsim.film import draw; draw.main()"
"""What a drawing process does: it looks whether its driver is there before anything slow."""

_END = 0.6  # s for which the last picture of a clip stays


def film(
    clips: Sequence[Clip | Sequence[Clip]],
    path: str | Path,
    *,
    camera: str = "",
    width: int = 1280,
    height: int = 720,
    fps: int = 25,
) -> Path:
    """Write a film (H.264) of clips one after the other; return its path.

    Several clips in one place are shown side by side, sample by sample.

    Two workers draw every other frame. The file appears under its name when it is whole.

    Raises
    ------
    RenderingError
        If nothing draws here; the message names the packages to install.
    SimulationError
        If a scene lacks a camera, a joint or an object that a clip names.
    """
    import imageio_ffmpeg

    if not clips:
        raise ArgumentError("no clips were given: give at least one")
    rows = [_row(clip) for clip in clips]
    frames = [(i, sample) for i, row in enumerate(rows) for sample in _samples(row[0], fps)]
    with whole_path(Path(path), replace=True) as unfinished:
        writer = imageio_ffmpeg.write_frames(
            str(unfinished),
            (width, height),
            fps=fps,
            codec="libx264",
            quality=None,
            ffmpeg_log_level="fatal",  # a film that is given up is no matter for paragraphs
            output_params=["-crf", "20", "-preset", "veryfast", "-movflags", "+faststart"],
        )
        with contextlib.closing(writer):
            writer.send(None)
            for picture in _pictures(rows, frames, camera, width, height, workers=2):
                writer.send(picture)
    return Path(path)


def still(
    clip: Clip | Sequence[Clip],
    time: float,
    path: str | Path,
    *,
    camera: str = "",
    width: int = 1280,
    height: int = 720,
) -> Path:
    """Write the picture of a clip at ``time`` s as PNG, with smoothed edges; return its path.

    Several clips are shown side by side, as in :func:`film`.

    Raises
    ------
    RenderingError, SimulationError
        As :func:`film`.
    """
    from PIL import Image

    row = _row(clip)
    sample = _at(row[0], np.array([time]))[0]
    (picture,) = _pictures([row], [(0, sample)], camera, width, height, antialias=4)
    with whole_path(Path(path), replace=True) as unfinished:
        Image.frombytes("RGB", (width, height), picture).save(unfinished)
    return Path(path)


def _row(clips: Clip | Sequence[Clip]) -> tuple[Clip, ...]:
    """Clips that are shown side by side."""
    row = (clips,) if isinstance(clips, Clip) else tuple(clips)
    lengths = {len(clip.time) for clip in row}
    if len(lengths) != 1:
        raise ArgumentError(
            f"clips side by side have {sorted(lengths)} samples; give one or more of equal length"
        )
    return row


def _samples(clip: Clip, fps: int) -> np.ndarray:
    """Index of the sample that each frame of a clip shows."""
    end = clip.time[-1] + _END * clip.speed
    return _at(clip, np.arange(clip.time[0], end, clip.speed / fps))


def _at(clip: Clip, time: np.ndarray) -> np.ndarray:
    """Index of the last sample at or before each time."""
    index = np.searchsorted(clip.time, time + 1e-9, side="right") - 1
    return np.clip(index, 0, len(clip.time) - 1)


def _pictures(
    rows: Sequence[Sequence[Clip]],
    frames: Sequence[tuple[int, int]],
    camera: str,
    width: int,
    height: int,
    *,
    antialias: int = 0,
    workers: int = 1,
) -> Iterator[bytes]:
    """Yield the RGB bytes of every (row, sample) of ``frames``, drawn by several workers."""
    for row in rows:
        for clip in row:
            _check(clip, camera)
    environment = rendering.environment()
    shares = [frames[i::workers] for i in range(workers)]
    processes = [
        _start((rows, share, camera, width, height, antialias), environment) for share in shares
    ]
    try:
        for i in range(len(frames)):
            yield _read(processes[i % workers], 3 * width * height)
    finally:
        for process in processes:
            process.kill()
            process.communicate()


def _start(job: tuple[object, ...], environment: dict[str, str]) -> "subprocess.Popen[bytes]":
    """Start a worker on a job."""
    process = subprocess.Popen(
        [sys.executable, "-c", _DRAW.format(os.getpid())],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment,
    )
    assert process.stdin is not None
    with contextlib.suppress(BrokenPipeError), process.stdin:
        pickle.dump(job, process.stdin)
    process.stdin = None
    return process


def _read(process: "subprocess.Popen[bytes]", size: int) -> bytes:
    """Read one picture from a worker."""
    assert process.stdout is not None and process.stderr is not None
    picture = process.stdout.read(size)
    if len(picture) < size:
        said = process.stderr.read().decode(errors="replace").strip().splitlines()
        reason = said[-1] if said else f"exit code {process.wait()}"
        raise RenderingError(f"the drawing process ended early: {reason}")
    return picture


def _check(clip: Clip, camera: str) -> None:
    """Look in the world of a clip for everything that the clip names."""
    world, wanted = clip.world, clip.camera or camera
    if wanted and wanted not in cameras(world.model):
        raise SimulationError(
            f"the scene has no camera {wanted!r}: its cameras are {cameras(world.model)}"
        )
    columns, joints = np.shape(clip.q)[1], len(world.description.joints)
    if columns != joints:
        raise SimulationError(f"q has {columns} columns: the robot has {joints} joints")
    for name in clip.objects:
        if name not in world.objects:
            raise SimulationError(
                f"the scene has no object {name!r}: its objects are {list(world.objects)}"
            )
