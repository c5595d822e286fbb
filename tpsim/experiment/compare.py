"""Section 8 as a table: how far the methods carry a movement from where it was shown."""

from collections.abc import Mapping, Sequence
from time import perf_counter

import numpy as np
from matplotlib.figure import Figure

from tpsim import plot
from tpsim.demonstration import Demonstration
from tpsim.errors import ArgumentError
from tpsim.examples import u_demonstration, u_demonstrations, u_frames
from tpsim.experiment.methods import METHODS, Frames
from tpsim.gaussian import Gaussian
from tpsim.study.canvas import INK

SPREADS = (0.5, 1.0, 2.0, 3.0)
"""How far the frames of the four situations range; the demonstrations have 1."""

ENTRY = 0.2  # length of the last piece of a path, whose direction is measured [m]


def situations(seed: int = 2016) -> list[Frames]:
    """Draw the four situations: frames ever farther along one way from their usual places."""
    stream = np.random.SeedSequence(seed, spawn_key=(0,))
    return [u_frames(np.random.default_rng(stream), spread) for spread in SPREADS]


def retrieve_all(
    demonstrations: Sequence[Demonstration], tasks: Sequence[Frames], names: Sequence[str] = ()
) -> dict[str, dict]:
    """Learn with every method and retrieve in every situation.

    Parameters
    ----------
    demonstrations : sequence of Demonstration
        Of equal length, with two frames.
    tasks : sequence of P frames
        The situations.
    names : sequence of str, optional
        Methods out of :data:`tpsim.experiment.methods.METHODS`; all by default.

    Returns
    -------
    dict
        By method: ``paths``, a Gaussian (T, D) for every situation, and the times ``learn_ms``
        and ``retrieve_ms``.
    """
    if unknown := [name for name in names if name not in METHODS]:
        raise ArgumentError(f"methods {unknown} are not known; there are {', '.join(METHODS)}")
    results = {}
    for name in names or METHODS:
        start = perf_counter()
        retrieve = METHODS[name](demonstrations)
        learned = perf_counter()
        paths = [retrieve(frames) for frames in tasks]
        each = (perf_counter() - learned) / len(tasks)
        results[name] = {
            "paths": paths,
            "learn_ms": 1e3 * (learned - start),
            "retrieve_ms": 1e3 * each,
        }
    return results


def measure(path: Gaussian, frames: Frames) -> dict[str, float]:
    """Measure a retrieved movement between two frames.

    Returns
    -------
    dict
        ``start_error`` and ``end_error`` [m], distances from the origins of the frames;
        ``end_x`` and ``end_y`` [m], the end as the second frame sees it; ``entry_angle`` [deg]
        between the last piece of the path and the open side of the second object; ``path_error``
        [m], root mean square distance from the teacher's own path in this situation.
    """
    x, (first, second) = path.mean, frames
    end = second.to_local(x[-1])
    away = np.linalg.norm(x - x[-1], axis=1)
    piece = x[np.flatnonzero(away > ENTRY)[-1]] - x[-1] if away.max() > ENTRY else x[0] - x[-1]
    axis = second.A[:, 1]
    cosine = piece @ axis / max(np.linalg.norm(piece) * np.linalg.norm(axis), 1e-12)
    taught = u_demonstration(frames, len(x)).data
    return {
        "start_error": float(np.linalg.norm(x[0] - first.b)),
        "end_error": float(np.linalg.norm(x[-1] - second.b)),
        "end_x": float(end[0]),
        "end_y": float(end[1]),
        "entry_angle": float(np.degrees(np.arccos(np.clip(cosine, -1, 1)))),
        "path_error": float(np.sqrt(((x - taught) ** 2).sum(1).mean())),
    }


def compare(count: int = 8, seed: int = 2016, names: Sequence[str] = ()) -> dict:
    """Compare the methods of Figs 12 to 14 in four situations of growing distance.

    Parameters
    ----------
    count : int
        Number of demonstrations, 2 or more.
    seed : int
        Draws demonstrations and situations.
    names : sequence of str, optional
        Methods; all by default.

    Returns
    -------
    dict
        ``rows`` with one method and situation each, and the numbers of :func:`measure`.
    """
    if count < 2:
        raise ArgumentError(f"count is {count}; the methods need at least 2 demonstrations")
    tasks = situations(seed)
    results = retrieve_all(u_demonstrations(count, rng=np.random.default_rng(seed)), tasks, names)
    rows = [
        {"method": name, "situation": n + 1, **measure(path, frames)}
        | {"learn_ms": result["learn_ms"], "retrieve_ms": result["retrieve_ms"]}
        for name, result in results.items()
        for n, (path, frames) in enumerate(zip(result["paths"], tasks, strict=True))
    ]
    return {"demonstrations": count, "seed": seed, "spreads": list(SPREADS), "rows": rows}


def figure(
    demonstrations: Sequence[Demonstration], tasks: Sequence[Frames], results: Mapping[str, dict]
) -> Figure:
    """Draw a row per method and a column per situation, like Figs 12 to 14.

    Parameters
    ----------
    demonstrations, tasks
        What :func:`retrieve_all` was given.
    results
        What it returned.
    """
    size = (2.0 * len(tasks), 1.5 * len(results))
    drawing = Figure(figsize=size, layout="constrained")
    grid = drawing.subplots(len(results), len(tasks), sharex=True, sharey=True, squeeze=False)
    for axes, (name, result) in zip(grid, results.items(), strict=True):
        axes[0].set_ylabel(name, color=INK)
        for axis, path, frames in zip(axes, result["paths"], tasks, strict=True):
            plot.demonstrations(axis, demonstrations)
            plot.tube(axis, path)
            plot.frames(axis, frames)
            axis.set_aspect("equal")
            axis.set_axis_off() if axis is not axes[0] else axis.set(xticks=[], yticks=[])
    return drawing
