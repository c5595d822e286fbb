"""The simulated plant, where it differs from the controller's model."""

import copy
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated

import mujoco
import numpy as np

from tpsim.border import Duration, NotNegative, Range, SeedNumber, Share, border, checked
from tpsim.errors import ArgumentError
from tpsim.robot.robot import Robot
from tpsim.world.perception import Perception

LONGEST_DELAY = 10.0
"""Latency [s] beyond which nothing is controlled any more."""


@dataclass(frozen=True)
class Plant:
    """How the simulated robot differs from its controller's model; nominal by default.

    Parameters
    ----------
    mass : float
        Masses and inertias of all links are scaled by factors within 1 -+ mass, each its own.
    payload : float
        Mass [kg] that every hand holds without the model's knowledge, as a point.
    friction : float
        Coulomb friction of every joint [Nm], beside that of the file.
    latency : float
        Time [s] between sensing and the torque that follows from it.
    encoder_bits : int, optional
        Joint angles are measured in steps of 2 pi / 2^bits, and velocities are then filtered
        differences; exact by default.
    velocity_cutoff : float
        Of that filter [Hz].
    control_period : float, optional
        Time [s] between two commands; every time step by default.
    perception : Perception, optional
        How objects are seen; exactly, at any time, by default.
    seed : int
        Of the factors of the masses.
    """

    mass: Share = 0.0
    payload: NotNegative = 0.0
    friction: NotNegative = 0.0
    latency: Annotated[float, Range(least=0, most=LONGEST_DELAY)] = 0.0
    encoder_bits: Annotated[int, Range(least=4, most=32)] | None = None
    velocity_cutoff: Annotated[float, Range(above=0, endless=True)] = 40.0
    control_period: Duration | None = None
    perception: Perception | None = None
    seed: SeedNumber = 0

    def __post_init__(self) -> None:
        checked(self)

    @property
    def is_nominal(self) -> bool:
        """Whether bodies and joints are those of the model."""
        return not (self.mass or self.payload or self.friction)

    @border
    def model(self, nominal: mujoco.MjModel, robot: Robot) -> mujoco.MjModel:
        """Compiled scene with the plant's own masses and friction; the nominal one is not changed.

        Raises
        ------
        ArgumentError
            If the motors cannot hold the arms at home.
        """
        if self.is_nominal:
            return nominal
        model = copy.copy(nominal)
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(0,)))
        factors = 1 + self.mass * rng.uniform(-1, 1, model.nbody)
        model.body_mass[:] *= factors
        model.body_inertia[:] *= factors[:, None]
        for site in robot.hands.values():
            _add_mass(model, model.site(site).id, self.payload)
        model.dof_frictionloss[robot.simulated.dof] += self.friction
        data = mujoco.MjData(model)
        mujoco.mj_setConst(model, data)
        data.qpos[robot.simulated.qpos] = robot.home
        mujoco.mj_forward(model, data)
        load = np.abs(data.qfrc_bias[robot.simulated.dof]) - robot.torque_limit
        if load.max() > 0:
            joint = robot.joints[int(load.argmax())]
            raise ArgumentError(
                f"this plant cannot hold itself up at home: joint '{joint}' lacks "
                f"{load.max():.1f} Nm; give it less mass or payload"
            )
        return model


NOMINAL = Plant()
"""The plant that the controller's model describes."""

PLANTS: Mapping[str, Plant] = MappingProxyType(
    {
        "mass 5 %": Plant(mass=0.05),
        "payload 0.3 kg": Plant(payload=0.3),
        "friction 0.1 Nm": Plant(friction=0.1),
        "friction 0.5 Nm": Plant(friction=0.5),
        "latency 1 ms": Plant(latency=0.001),
        "latency 5 ms": Plant(latency=0.005),
        "encoders 14 bit": Plant(encoder_bits=14),
        "control 500 Hz": Plant(control_period=0.002),
        "control 200 Hz": Plant(control_period=0.005),
        "control 100 Hz": Plant(control_period=0.01),
        "camera 20 Hz": Plant(perception=Perception()),
        "all at middle values": Plant(
            mass=0.03,
            payload=0.15,
            friction=0.3,
            latency=0.003,
            encoder_bits=14,
            control_period=0.002,
        ),
    }
)
"""Plants that real arms resemble, by name: each difference alone, and all together."""


def _add_mass(model: mujoco.MjModel, site: int, mass: float) -> None:
    """Add a point mass to the body of a site, at the site."""
    if not mass:
        return
    body = model.site_bodyid[site]
    m, c = model.body_mass[body], model.body_ipos[body].copy()
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, model.body_iquat[body])
    R = flat.reshape(3, 3)
    inertia = R @ np.diag(model.body_inertia[body]) @ R.T
    point = model.site_pos[site]
    centre = (m * c + mass * point) / (m + mass)
    inertia = inertia + _steiner(m, c - centre) + _steiner(mass, point - centre)
    values, V = np.linalg.eigh(inertia)
    V[:, 0] *= np.sign(np.linalg.det(V))
    model.body_mass[body], model.body_ipos[body] = m + mass, centre
    model.body_inertia[body] = values
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, V.ravel())
    model.body_iquat[body] = quaternion


def _steiner(mass: float, d: np.ndarray) -> np.ndarray:
    return mass * (d @ d * np.eye(3) - np.outer(d, d))


class Sensors:
    """What encoders say of joints: quantised angles, and filtered differences of these.

    Parameters
    ----------
    plant : Plant
    timestep : float
        Between two measurements [s].
    """

    def __init__(self, plant: Plant, timestep: float):
        assert plant.encoder_bits is not None
        self._step = 2 * np.pi / 2**plant.encoder_bits
        self._timestep = timestep
        self._keep = float(np.exp(-2 * np.pi * plant.velocity_cutoff * timestep))
        self._last: np.ndarray | None = None

    def measure(self, x: np.ndarray) -> np.ndarray:
        """Angles over velocities (2 n,) as they are measured."""
        n = len(x) // 2
        q = self._step * np.round(x[:n] / self._step)
        if self._last is None:
            dq = np.zeros(n)
        else:
            rate = (q - self._last[:n]) / self._timestep
            dq = self._keep * self._last[n:] + (1 - self._keep) * rate
        self._last = np.concatenate((q, dq))
        return self._last


class Delay:
    """Torques that reach the motors some steps later.

    Parameters
    ----------
    plant : Plant
    timestep : float
        [s]
    first : (n,)
        Torque at the motors until the first command arrives [Nm].
    """

    def __init__(self, plant: Plant, timestep: float, first: np.ndarray):
        steps = round(plant.latency / timestep)
        self._waiting = deque([first] * steps)

    def pass_on(self, torque: np.ndarray) -> np.ndarray:
        """Take the torque of now, give the one that arrives now."""
        self._waiting.append(torque)
        return self._waiting.popleft()
