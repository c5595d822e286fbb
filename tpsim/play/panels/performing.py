"""The panel to perform, push and record."""

from typing import TYPE_CHECKING

import numpy as np
import viser

from tpsim.play.recording import Recorded

if TYPE_CHECKING:
    from tpsim.play.page import Page

SLIDERS = {
    "effort": "Effort: high is soft",
    "friction": "Friction felt [Ns/m]",
}
"""Fields of tasks that say how the robot behaves, and their names in the page."""

SPAN = 100.0
"""A slider goes from the usual value over this factor to as many times it."""

SPEEDS = ("1", "1/2", "1/4", "1/10")

NOBODY = "nobody"


class PerformingPanel:
    """Buttons and sliders of what performs.

    Parameters
    ----------
    page : Page
    """

    def __init__(self, page: "Page"):
        self._page, gui = page, page.server.gui
        session = page.session
        buttons = {
            "Start again": (viser.Icon.PLAYER_TRACK_PREV, session.perform),
            "Another situation": (viser.Icon.DICE, session.next_situation),
        }
        for label, (icon, work) in buttons.items():
            gui.add_button(label, icon=icon).on_click(page.guarded(self._locked(work)))
        self._controller = gui.add_dropdown(
            "Controller",
            session.controllers,
            initial_value=session.controller,
            hint="Who drives the robot",
        )
        self._controller.on_update(page.guarded(self._locked(self._choose)))
        self._beside = gui.add_dropdown(
            "Ghost",
            (NOBODY, *session.controllers),
            initial_value=NOBODY,
            hint="Pushed with the same forces",
        )
        self._beside.on_update(page.guarded(self._locked(self._compare)))
        self._sliders = {name: self._slider(name, label) for name, label in SLIDERS.items()}
        with gui.add_folder("Time"):
            self._speed = gui.add_dropdown("Speed", SPEEDS)
            self._speed.on_update(page.guarded(self._pace))
            self._pause = gui.add_button("Pause", icon=viser.Icon.PLAYER_PAUSE)
            self._pause.on_click(page.guarded(self._toggle))
            step = gui.add_button("One step of 10 ms", icon=viser.Icon.PLAYER_SKIP_FORWARD)
            step.on_click(page.guarded(self._step))
        with gui.add_folder("Record"):
            self._record = gui.add_button("Record from the start", icon=viser.Icon.PLAYER_RECORD)
            self._record.on_click(page.guarded(self._toggle_record))
            self._kept = gui.add_markdown("")
        self._paused = False
        self.refresh()

    def refresh(self) -> None:
        """Bring it to the state of the session."""
        session = self._page.session
        offer(self._controller, session.controllers, session.controller)
        offer(self._beside, (NOBODY, *session.controllers), session.compared or NOBODY)
        recording = session.recording and session.mode == "perform"
        self._record.label = "Stop and keep" if recording else "Record from the start"
        self._record.color = "red" if recording else None
        self._record.disabled = session.mode == "teach" and session.recording
        self._pause.label = "Go on" if self._paused else "Pause"

    def _locked(self, work):  # type: ignore[no-untyped-def]
        def call() -> None:
            with self._page.session.lock:
                work()

        return call

    def _choose(self) -> None:
        session = self._page.session
        if self._controller.value != session.controller:
            session.perform(self._controller.value)

    def _compare(self) -> None:
        session, chosen = self._page.session, self._beside.value
        if (chosen if chosen != NOBODY else "") != session.compared:
            session.compare("" if chosen == NOBODY else chosen)

    def _slider(self, name: str, label: str):  # type: ignore[no-untyped-def]
        """A slider over decades, for a field of the task that is a number."""
        usual = getattr(self._page.session.task, name, None)
        if not isinstance(usual, float) or usual <= 0:
            return None
        ends = np.log10(usual) + np.log10(SPAN) * np.array([-1, 1])
        slider = self._page.server.gui.add_slider(
            label,
            round(float(ends[0]), 2),
            round(float(ends[1]), 2),
            0.05,
            round(float(np.log10(usual)), 2),
            marks=((float(np.log10(usual)), "usual"),),
            hint="Power of ten",
        )

        def change() -> None:
            with self._page.session.lock:
                self._page.session.set_fields(**{name: float(10**slider.value)})

        slider.on_update(self._page.guarded(change))
        return slider

    def _pace(self) -> None:
        above, _, below = self._speed.value.partition("/")
        pace = float(above) / float(below or 1)
        with self._page.session.lock:
            self._page.session.speed = 0.0 if self._paused else pace

    def _toggle(self) -> None:
        self._paused = not self._paused
        self._pace()

    def _step(self) -> None:
        if not self._paused:
            self._toggle()
        session = self._page.session
        with session.lock:
            session.advance(max(1, round(0.01 / session.world.timestep)))

    def _toggle_record(self) -> None:
        session = self._page.session
        with session.lock:
            if not session.recording:
                session.record()
                return
            recorded = session.stop()
        self.take(recorded)

    def take(self, recorded: Recorded) -> None:
        """Keep a performance."""
        page, session = self._page, self._page.session
        study, models = session.study, session.models
        assert models is not None
        place = page.shelf.keep_performance(study, models, recorded, session.seed)
        self._kept.content = f"Kept in `{place}`; `tpsim replay` repeats it bit for bit."


def offer(dropdown, options: tuple[str, ...], value: str) -> None:  # type: ignore[no-untyped-def]
    """Change a dropdown where it differs, so that its callbacks have nothing to do."""
    if tuple(dropdown.options) != options:
        dropdown.options = options
    if dropdown.value != value:
        dropdown.value = value
