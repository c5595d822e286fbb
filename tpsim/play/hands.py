"""Hands of people in one roll-out: who pulls what at the moment, and what all of them did."""

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.pose import Pose
from tpsim.task.task import Others
from tpsim.world.people.drag import PULL, BoundDrag, Drag, Quaternion
from tpsim.world.people.guide import Grip
from tpsim.world.rollout import Rollout

LEAD = Grip(600.0, 60.0, 20.0, 1.2, 40.0, 5.0)
"""A person's hand that leads a hand of the robot, and keeps it turned as it wants."""


@dataclass(frozen=True)
class Pull:
    """One hand at work.

    Parameters
    ----------
    drag : BoundDrag
    others : tuple of BoundDrag
        What holds the other hands meanwhile.
    """

    drag: BoundDrag
    others: tuple[BoundDrag, ...] = ()


class Hands:
    """Hands in one roll-out, by whom they belong to.

    Parameters
    ----------
    going : Rollout
    """

    def __init__(self, going: Rollout):
        self._going, self._simulation = going, going.episode.simulation
        self._pulls: dict[Hashable, Pull] = {}
        self._all: list[BoundDrag] = []

    def __len__(self) -> int:
        """Return how many pull now."""
        return len(self._pulls)

    @property
    def pulling(self) -> dict[Hashable, Pull]:
        """Those that pull now."""
        return dict(self._pulls)

    def grab(
        self,
        who: Hashable,
        body: str,
        where: np.ndarray,
        *,
        leads: bool = False,
        others: Others = "free",
        turned: Quaternion | None = None,
    ) -> None:
        """Take hold of a body or site at a point (3,) of the world [m].

        Parameters
        ----------
        who : hashable
            Whose hand it is; one hand holds one thing.
        body : str
        where : (3,)
            Wanted from now on, too.
        leads : bool
            Whether it teaches: with a firmer grip, that keeps the hands of the robot turned.
        others : str
            What becomes of the other hands meanwhile.
        turned : (4,), optional
            How the body or site is wanted; as it is now by default, where a hand is led.
        """
        self.let_go(who)
        pose = self._pose(body)
        hand = self._hand_of(body)
        point = pose.rotation.T @ (np.asarray(where, float) - pose.position)
        keeps = leads and hand is not None
        if keeps and turned is None:
            turned = _quaternion(pose)
        drag = self._bind(
            "guide" if leads else "push",
            body,
            where,
            turned if keeps else None,
            point,
            LEAD if leads else PULL,
        )
        held = () if hand is None or not leads else self._hold(hand, others)
        self._pulls[who] = Pull(drag, held)

    def want(self, who: Hashable, where: np.ndarray, turned: Quaternion | None = None) -> None:
        """Pull somewhere else from the next time step on; of no use to who holds nothing."""
        pull = self._pulls.get(who)
        if pull is not None:
            at = tuple(np.asarray(where, float).tolist())
            pull.drag.want(self._going.steps, at, turned or pull.drag.turned)

    def let_go(self, who: Hashable) -> None:
        """Let go; of no use to who holds nothing."""
        pull = self._pulls.pop(who, None)
        if pull is not None:
            for drag in (pull.drag, *pull.others):
                drag.let_go(self._going.steps)

    def all_let_go(self) -> None:
        """Let go of everything."""
        for who in list(self._pulls):
            self.let_go(who)

    def forget(self) -> None:
        """Forget hands that have let go; for a roll-out that is not recorded."""
        if not all(drag.held for drag in self._all):
            self._all = [drag for drag in self._all if drag.held]
            self._going.episode.people[:] = self._all
            self._simulation.clear_wrenches()

    def values(self) -> tuple[Drag, ...]:
        """What all hands did up to now."""
        return tuple(drag.value(self._going.steps) for drag in self._all)

    def _hold(self, hand: str, others: Others) -> tuple[BoundDrag, ...]:
        found = []
        for site in self._simulation.robot.hands.values():
            if site == hand or others == "free":
                continue
            pose, relative_to = self._pose(site), None
            if others == "following":
                pose, relative_to = self._pose(hand).inverse @ pose, hand
            found.append(
                self._bind(
                    "other_guide",
                    site,
                    pose.position,
                    _quaternion(pose),
                    np.zeros(3),
                    LEAD,
                    relative_to,
                )
            )
        return tuple(found)

    def _bind(
        self,
        name: str,
        body: str,
        where: np.ndarray,
        turned: Quaternion | None,
        point: np.ndarray,
        grip: Grip,
        relative_to: str | None = None,
    ) -> BoundDrag:
        now = self._going.steps * self._simulation.timestep
        drag = Drag(
            name,
            body,
            (now,),
            (tuple(np.asarray(where, float).tolist()),),
            None if turned is None else (turned,),
            point=tuple(point.tolist()),
            grip=grip,
            relative_to=relative_to,
        ).bind(self._simulation)
        self._all.append(drag)
        self._going.episode.people.append(drag)
        return drag

    def _pose(self, name: str) -> Pose:
        body, R, p = self._simulation.attachment(name)
        data = self._simulation.data
        return Pose(data.xmat[body].reshape(3, 3).copy(), data.xpos[body].copy()) @ Pose(R, p)

    def _hand_of(self, name: str) -> str | None:
        """Site of the hand that a body or site is part of, or moves with."""
        model = self._simulation.model
        root = model.body_weldid[self._simulation.attachment(name)[0]]
        for site in self._simulation.robot.hands.values():
            if model.body_weldid[self._simulation.attachment(site)[0]] == root:
                return site
        return None


def body_name(model, body: int) -> str:  # type: ignore[no-untyped-def]
    """Name of a body that can be held.

    Raises
    ------
    ArgumentError
        If it has none.
    """
    name: str = model.body(body).name
    if not name:
        raise ArgumentError(
            f"body {body} has no name and cannot be held; name it in the robot's file"
        )
    return name


def _quaternion(pose: Pose) -> Quaternion:
    w, x, y, z = pose.quaternion.tolist()
    return w, x, y, z
