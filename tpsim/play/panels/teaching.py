"""The panel to teach by hand."""

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
import viser

from tpsim.play.panels.frames import FramePlot
from tpsim.play.recording import Recorded
from tpsim.play.session import LONGEST
from tpsim.plot.style import PALETTE
from tpsim.task.task import Behaviour, Others

if TYPE_CHECKING:
    from tpsim.play.page import Page

OTHERS: tuple[Others, ...] = ("held", "following", "free")

GIZMO = 0.05, 0.16
"""Size of a gizmo [m], at least and at most."""

SEGMENTS = 200
"""Lines of a trace, at most."""


class TeachingPanel:
    """Buttons to show, keep and throw away; gizmos on the hands; traces of what was shown.

    Parameters
    ----------
    page : Page
    """

    def __init__(self, page: "Page"):
        self._page, gui = page, page.server.gui
        behaviours = tuple(page.session.task.behaviours())
        self._behaviour = gui.add_dropdown("Show", behaviours)
        self._behaviour.on_update(page.guarded(self._turn_to))
        self._asks = gui.add_markdown("")
        self._others = gui.add_dropdown("Other hand", OTHERS, initial_value=self._asked.others)
        self._others.on_update(page.guarded(self._choose))
        self._show = gui.add_button("Start a demonstration", icon=viser.Icon.PLAYER_RECORD)
        self._show.on_click(page.guarded(self._toggle))
        self._keep = gui.add_button("Keep it", icon=viser.Icon.CHECK, visible=False)
        self._keep.on_click(page.guarded(self._keep_it))
        self._drop = gui.add_button("Throw it away", icon=viser.Icon.TRASH, visible=False)
        self._drop.on_click(page.guarded(self._drop_it))
        self._said = gui.add_markdown("")
        self._back = gui.add_button("Back to the start", icon=viser.Icon.PLAYER_TRACK_PREV)
        self._back.on_click(page.guarded(self._begin_again))
        self._free = gui.add_button("Make the arms weightless", icon=viser.Icon.FEATHER)
        self._free.on_click(page.guarded(self._teach))
        self._last = gui.add_button("Throw the last kept away", icon=viser.Icon.TRASH)
        self._last.on_click(page.guarded(self._drop_last))
        self._frame_plot = FramePlot(gui, page.session.task)
        self._pending: Recorded | None = None
        self._note = ""
        hands, size = page.session.world.robot.hands, self._gizmo_size()
        self._gizmos = {site: self._gizmo(name, site, size) for name, site in hands.items()}
        self._led: dict[str, int] = {}
        self._traces: list = []
        self._choose()
        self.refresh()

    def refresh(self) -> None:
        """Bring it to the state of the session."""
        session, shown = self._page.session, self._page.lessons.shown
        showing = session.mode == "teach" and (session.recording or session.armed)
        self._show.label = "Stop" if showing else "Start a demonstration"
        self._show.color = "red" if showing else None
        self._free.visible = session.mode != "teach"
        self._back.visible = session.mode == "teach" and not session.recording
        self._asks.content = self.asked()
        self._keep.visible = self._drop.visible = self._pending is not None
        self._last.disabled = not any(shown.values())
        self._keep.label = "Keep it"
        if self._pending is not None and self._pending.fault:
            self._keep.label = "Keep it all the same"
        words = self._note if self._pending is None else self._verdict(self._pending)
        words += "\n\n" if words else ""
        self._said.content = words + "  \n".join(map(self._counted, shown))

    def _counted(self, behaviour: str) -> str:
        """How often a behaviour was shown, and how often it is to be."""
        lessons = self._page.lessons
        shown, missing = lessons.shown[behaviour], lessons.missing.get(behaviour, 0)
        poor = sum(bool(recorded.fault) for recorded in shown)
        words = f"{behaviour}: {len(shown)} shown" + (f" ({poor} better not)" if poor else "")
        return words + (f", {missing} more needed" if missing else ", enough")

    def asked(self) -> str:
        """What a person is asked to show."""
        return self._asked.asks or "Take a hand of the robot and lead it."

    @property
    def _asked(self) -> Behaviour:
        """The behaviour that is chosen."""
        return self._page.session.task.behaviours()[self._behaviour.value]

    def follow(self) -> None:
        """Bring the gizmos to the hands, but those that somebody holds."""
        session = self._page.session
        for site, gizmo in self._gizmos.items():
            gizmo.visible = session.mode == "teach"
            if session.mode == "teach" and site not in self._led:
                with session.lock:
                    pose = session.world.robot.at(session.going.state.q).pose(site)
                gizmo.position, gizmo.wxyz = pose.position, pose.quaternion

    def gone(self, client: int) -> None:
        """Gizmos that a browser held when it went follow the hands again."""
        for site in [site for site, holder in self._led.items() if holder == client]:
            self._led.pop(site, None)

    @staticmethod
    def _verdict(recorded: Recorded) -> str:
        seconds, fault = recorded.condition.duration or 0.0, recorded.fault
        ended = " It ended by itself there." if seconds >= LONGEST else ""
        return f"**{seconds:.1f} s of {recorded.behaviour}.**{ended} " + (
            f"Better not: {fault}. Throw it away, and try again." if fault else "Well shown."
        )

    def _gizmo_size(self) -> float:
        """Size of gizmos [m] that do not overlap where the hands are at first."""
        session = self._page.session
        state = session.world.robot.at(session.situation.start)
        hands = [state.pose(site).position for site in session.world.robot.hands.values()]
        apart = [np.linalg.norm(one - other) for one, other in combinations(hands, 2)]
        return float(np.clip(0.5 * min(apart, default=1.0), *GIZMO))

    def _gizmo(self, name: str, site: str, size: float):  # type: ignore[no-untyped-def]
        gizmo = self._page.server.scene.add_transform_controls(
            f"/gizmo/{name}", size, line_width=3.0, depth_test=False, visible=False
        )

        # A coroutine: phases are told in order.
        @gizmo.on_update
        async def _(event) -> None:  # type: ignore[no-untyped-def]
            session, who = self._page.session, (site, event.client_id)
            wanted = gizmo.position, _four(gizmo.wxyz)
            with session.lock:
                if event.phase == "start":
                    self._led[site] = event.client_id
                    session.grab(who, site, *wanted)
                elif event.phase == "update":
                    session.move(who, *wanted)
                else:
                    self._led.pop(site, None)
                    session.let_go(who)

        return gizmo

    def _turn_to(self) -> None:
        """Show another behaviour, with what the other hand usually does then."""
        # Its callback chooses.
        self._others.value = self._asked.others  # type: ignore[misc]  # mypy loses the setter of a generic base

    def _teach(self) -> None:
        with self._page.session.lock:
            self._page.session.teach()

    def _choose(self) -> None:
        self._page.session.others = self._others.value

    def _toggle(self) -> None:
        session, self._note = self._page.session, ""
        with session.lock:
            if not (session.mode == "teach" and (session.recording or session.armed)):
                session.start_demonstration(self._behaviour.value)
                self._pending = None
                return
            if session.armed and not session.recording:
                session.armed = False
                self._note = "**Nothing was recorded:** no hand was taken. Try again."
                return
            recorded = session.stop()
        self.take(recorded)

    def take(self, recorded: Recorded) -> None:
        """Judge a demonstration, and ask what shall become of it."""
        page = self._page
        self._pending = page.lessons.judge(page.session.task, recorded)

    def _keep_it(self) -> None:
        page, pending = self._page, self._pending
        if pending is None:
            return
        kept = [*page.lessons.shown[pending.behaviour], pending]
        session = page.session
        page.shelf.keep_demonstrations(session.study, pending.behaviour, kept, session.seed)
        page.lessons.keep(pending)
        self._pending = None
        self._draw()

    def _drop_it(self) -> None:
        self._pending, self._note = None, ""
        if self._page.session.mode == "teach":
            self._begin_again()

    def _begin_again(self) -> None:
        """Bring the arms to where they started."""
        with self._page.session.lock:
            self._page.session.reset()

    def _drop_last(self) -> None:
        page, behaviour = self._page, self._behaviour.value
        page.lessons.throw_away(behaviour)
        session, shown = page.session, page.lessons.shown[behaviour]
        page.shelf.keep_demonstrations(session.study, behaviour, shown, session.seed)
        self._draw()

    def _draw(self) -> None:
        """Traces of the hands in all that was kept, and what frames saw of it."""
        self._frame_plot.show(self._page.lessons.look(self._page.session.task))
        for trace in self._traces:
            trace.remove()
        self._traces = []
        for k, (behaviour, found) in enumerate(self._page.lessons.shown.items()):
            red, green, blue = bytes.fromhex(PALETTE[k % len(PALETTE)][1:])
            for number, recorded in enumerate(found):
                for hand in self._page.session.world.robot.hands:
                    if f"{hand}_position" not in recorded.trial.arrays:
                        continue
                    path = recorded.trial[f"{hand}_position"]
                    path = path[:: max(1, len(path) // SEGMENTS)]
                    if np.ptp(path, axis=0).max() < 0.01:
                        continue
                    self._traces.append(
                        self._page.server.scene.add_line_segments(
                            f"/shown/{behaviour}/{number}/{hand}",
                            np.stack([path[:-1], path[1:]], axis=1),
                            (red, green, blue),
                        )
                    )


def _four(quaternion: np.ndarray) -> tuple[float, float, float, float]:
    w, x, y, z = np.asarray(quaternion, float).tolist()
    return w, x, y, z
