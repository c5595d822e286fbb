"""The page: what people see of a session, and what their clicks and drags do in it."""

import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np
import viser

from tpsim.errors import TpsimError, one_line
from tpsim.play.clock import RealTime
from tpsim.play.curves import Curves
from tpsim.play.lessons import Learned, Lessons
from tpsim.play.panels.learning import LearningPanel
from tpsim.play.panels.performing import PerformingPanel
from tpsim.play.panels.teaching import TeachingPanel
from tpsim.play.session import LONGEST, Session
from tpsim.play.shelf import Shelf
from tpsim.play.stage import Picture, Stage
from tpsim.task.acceptance import worded
from tpsim.world.teaching import at_limits

FRAMES = 33.0
"""Pictures per second."""

NEAR = 0.15
"""Distance to a joint limit [rad] at which who leads the arm is warned."""

EVERY = 3
"""Pictures between two looks at stiffness and curves."""


class Page:
    """One page, which any number of browsers see.

    Parameters
    ----------
    server : viser.ViserServer
    session : Session
    clock : RealTime
    lessons : Lessons
    shelf : Shelf
    """

    def __init__(
        self,
        server: viser.ViserServer,
        session: Session,
        clock: RealTime,
        lessons: Lessons,
        shelf: Shelf,
    ):
        self.server, self.session, self.clock = server, session, clock
        self.lessons, self.shelf = lessons, shelf
        self.pictures = 0
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        server.gui.main_panel.dock_right()
        server.gui.main_panel.set_width(300)
        self.stage = Stage(server, session.world, self._grabbed)
        self._status = server.gui.add_markdown("")
        tabs = server.gui.add_tab_group()
        with tabs.add_tab("Push", viser.Icon.HAND_FINGER):
            self._performing = PerformingPanel(self)
        with tabs.add_tab("Teach", viser.Icon.HAND_GRAB):
            self._teaching = TeachingPanel(self)
        with tabs.add_tab("Learn", viser.Icon.SCHOOL):
            self._learning = LearningPanel(self)
        self._curves = Curves(server, session)
        self._ended = threading.Event()
        self._painter = threading.Thread(target=self._paint, name="tpsim page", daemon=True)
        server.on_client_disconnect(self._gone)
        self._painter.start()

    def show(self, learned: Learned) -> None:
        """Say what was learned."""
        self._learning.show(learned)

    def is_alive(self) -> bool:
        """Whether time passes."""
        return self.clock.is_alive()

    def close(self) -> None:
        """Stop drawing."""
        self._ended.set()
        self._painter.join()

    def tell(
        self,
        title: str,
        words: str,
        colour: Literal["red", "yellow", "green"] = "red",
        client: viser.ClientHandle | None = None,
    ) -> None:
        """Say something in the page: to one browser, or to all."""
        everybody = list(self.server.get_clients().values())
        clients = everybody if client is None else [client]
        for each in clients:
            each.add_notification(title, words, auto_close_seconds=8.0, color=colour)

    def guarded(self, work: Callable[[], object]) -> Callable[[object], None]:
        """A callback that says in the page what went wrong."""

        def call(event: object) -> None:
            try:
                work()
            except TpsimError as error:
                self.tell(
                    "That does not work", one_line(error), client=getattr(event, "client", None)
                )
            except OSError as error:
                self.tell("That could not be written", one_line(error))
            self.refresh()

        return call

    def refresh(self) -> None:
        """Bring all panels to the state of the session."""
        self._performing.refresh()
        self._teaching.refresh()
        self._learning.refresh()

    def _grabbed(
        self, client: int, body: int, phase: str, here: np.ndarray, wanted: np.ndarray
    ) -> None:
        session, who = self.session, ("mouse", client)
        try:
            with session.lock:
                if phase == "start":
                    session.grab(who, body, here)
                if phase == "end":
                    session.let_go(who)
                else:
                    session.move(who, wanted)
        except TpsimError as error:
            self.tell("That cannot be held", one_line(error))

    def _gone(self, client: viser.ClientHandle) -> None:
        """A browser that is gone holds nothing."""
        with self.session.lock:
            for who in {*self.session.pulls, *self.session.led.takers}:
                if isinstance(who, tuple) and who[1] == client.client_id:
                    self.session.let_go(who)
        self._teaching.gone(client.client_id)

    def _paint(self) -> None:
        due, said = time.monotonic(), ""
        while not self._ended.is_set():
            looks = self.pictures % EVERY == 0
            with self.session.lock:
                picture = Picture.of(self.session, stiffness=looks)
                message, self.session.message = self.session.message, ""
                ended, self.session.ended = self.session.ended, None
                if looks:
                    self._curves.note()
            self.stage.draw(picture, stiffness=looks)
            if looks:
                self._curves.draw()
                self._teaching.follow()
                words = self._words()
                if words != said:
                    said = self._status.content = words
            if ended is not None:
                panel = self._teaching if ended.behaviour else self._performing
                self.guarded(partial(panel.take, ended))(None)
            if message:
                self.tell("tpsim", message, "yellow")
                self.refresh()
            if self.clock.failure is not None:
                self.tell("The simulation ended", one_line(self.clock.failure))
                return
            self.pictures += 1
            due = max(due + 1 / FRAMES, time.monotonic() - 0.1)
            self._ended.wait(max(0.002, due - time.monotonic()))

    def _shown(self) -> str:
        """How far what is shown is from what the behaviour asks for, now."""
        session = self.session
        goals, state = session.task.behaviours()[session.behaviour].goals, session.going.state
        near = at_limits(state.robot, state.q, NEAR)
        warning = f"  \n**{near[0]} is near its limit:** lead elsewhere" if near else ""
        return warning + "".join(
            "  \n" + worded(state.robot, name, goal, float(np.linalg.norm(goal.view(state).value)))
            for name, goal in goals.items()
            if goal.since <= 0.0 and goal.until == np.inf
        )

    def _words(self) -> str:
        session = self.session
        if session.recording and session.mode == "teach":
            what = f"**● Recording** {session.behaviour}, {LONGEST:g} s at most{self._shown()}"
        elif session.recording:
            what = "**● Recording**"
        elif session.armed:
            what = (
                f"**{self._teaching.asked()}** Pull a gripper, or an arrow on it. "
                "Recording starts when you do."
            )
        elif session.mode == "teach":
            what = (
                "**Weightless.** Drag the hands; drag objects to where you want them. "
                "Left and right are the robot's."
            )
        else:
            what = f"**{session.controller.capitalize()}** controller. Drag any part to push it."
        factor = self.clock.pace.factor * session.speed
        pace = f"{factor:.2f}× time" if session.speed else "paused"
        return f"{what}  \nsituation {session.index} · {session.time:.1f} s · {pace}"
