"""What the rows of movement primitives share: letters, a decay s, a spring and a damper."""

from collections.abc import Callable
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tpsim import (
    GMM,
    Demonstration,
    Frame,
    Gaussian,
    Motion,
    attractor_path,
    decay,
    forced_attractor,
    forcing_term,
    gmr,
    plot,
    spring_damper,
)
from tpsim.examples import letters
from tpsim.gallery import Bounded, Draw, Main, within

STIFFNESS, DAMPING, DT = 50.0, 10.0, 0.01
TAUGHT = letters("G", samples=201)
MEAN = np.mean([d.data for d in TAUGHT], axis=0)
START, GOAL = np.r_[TAUGHT[0].data[0], 0.0, 0.0], TAUGHT[0].data[-1]
NEW_GOAL = Frame(np.eye(2), GOAL + np.array([0.0, 1.5]))
S = decay(201, DT)


def forces() -> list[np.ndarray]:
    """Forcing term (T, 2) of every demonstration, for one goal."""
    motions = [Motion.of(d.data, DT) for d in TAUGHT]
    return [forcing_term(motion, GOAL, S, STIFFNESS, DAMPING) for motion in motions]


def attractors() -> list[np.ndarray]:
    """Attractor (T, 2) of every demonstration."""
    return [attractor_path(Motion.of(d.data, DT), STIFFNESS, DAMPING) for d in TAUGHT]


def seen_from_goal() -> list[Demonstration]:
    """Attractors over the decay [s, x], each seen from its own goal."""
    return [
        Demonstration(d.time, path, (Frame(np.eye(2), d.data[-1]),)).with_time(S)
        for d, path in zip(TAUGHT, attractors(), strict=True)
    ]


def follow(attractor: np.ndarray) -> np.ndarray:
    """Movement (T, 2) of the mass that is tied to the attractor."""
    return spring_damper(attractor, STIFFNESS, DAMPING, DT, START).states[:, :2]


def rms_from_mean(path: np.ndarray, greatest: float, reason: str) -> Bounded:
    """Root mean square distance from the mean letter [m]; the letter is 2 m high."""
    return within(np.sqrt(((path - MEAN) ** 2).sum(1).mean()), 0, greatest, reason)


def miss(path: np.ndarray, goal: np.ndarray, greatest: float, reason: str) -> Bounded:
    """Distance between the end and the goal [m]."""
    return within(np.linalg.norm(path[-1] - goal), 0, greatest, reason)


def force_row(learn: Callable[[], GMM], greatest: float, reason: str) -> tuple[Main, Draw]:
    """Functions ``main`` and ``draw`` of a row that learns the forcing term [s, F].

    ``greatest`` bounds the root mean square distance from the mean letter [m], with its reason.
    """

    @cache
    def retrieve() -> tuple[Gaussian, Gaussian, np.ndarray]:
        forcing = gmr(learn(), S)
        attractor = forced_attractor(GOAL, forcing.mean, S, STIFFNESS)
        # The force is s F, so its spread fades with s; stiffness turns it into a displacement.
        spread = (S / STIFFNESS)[:, None, None] ** 2 * forcing.covariance
        return forcing, Gaussian(attractor, spread), follow(attractor)

    def main() -> dict[str, Bounded]:
        path = retrieve()[2]
        return {
            "distance_to_goal_m": miss(path, GOAL, 0.1, "the force has faded to 13 %"),
            "rms_from_the_mean_letter_m": rms_from_mean(path, greatest, reason),
        }

    def draw_row(figure: Figure) -> None:
        forcing, attractor, path = retrieve()
        plane, curve = plot.panels(figure, 1, 2, kind=["plane", "curve"])
        draw(plane, path, attractor, GOAL)
        draw_forces(curve, forcing)
        plot.legend(figure, columns=3)

    return main, draw_row


def draw(axis: Axes, path: np.ndarray, attractor: Gaussian, goal: np.ndarray) -> None:
    """Draw letters, attractor with its spread, the movement and its goal."""
    plot.demonstrations(axis, TAUGHT, label="demonstrations")
    plot.tube(axis, attractor, label="attractor, with its spread")
    axis.plot(*path.T, color=plot.INK, lw=2.2, label="movement", zorder=4)
    plot.points(axis, goal, plot.PALETTE[0], marker="X", label="goal")
    axis.set(xlabel="x [m]", ylabel="y [m]")


def draw_forces(axis: Axes, forcing: Gaussian) -> None:
    """Draw the forcing term over the decay, which runs from 1 to 0."""
    for k, name in enumerate(("force along x", "force along y")):
        for force in forces():
            axis.plot(S, force[:, k], color=plot.INK, lw=0.6, alpha=0.3)
        deviation = np.sqrt(forcing.covariance[:, k, k])
        plot.band(axis, S, forcing.mean[:, k], deviation, plot.PALETTE[2 + k], label=name)
    axis.set(xlabel="decay s, from 1 to 0", ylabel="forcing term [m/s²]", xlim=(1, S[-1]))
