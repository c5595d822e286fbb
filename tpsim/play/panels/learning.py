"""The panel to learn from what was shown."""

from dataclasses import fields
from typing import TYPE_CHECKING

import viser

from tpsim.film.marks import Ellipsoid, Ellipsoids
from tpsim.play.learned import ellipsoids
from tpsim.play.lessons import Learned
from tpsim.play.panels.frames import CONFIG, FramePlot
from tpsim.play.seen import matters, plot_matters
from tpsim.plot.style import PALETTE

if TYPE_CHECKING:
    from tpsim.play.page import Page


class LearningPanel:
    """How it is learned, and what was.

    Parameters
    ----------
    page : Page
    """

    def __init__(self, page: "Page"):
        self._page, gui = page, page.server.gui
        task = page.session.task
        self._button = gui.add_button("Learn from what was shown", icon=viser.Icon.SCHOOL)
        self._button.on_click(page.guarded(self._learn))
        self._missing = gui.add_markdown("")
        self._said = gui.add_markdown("")
        self._components, self._frames = None, {}
        with gui.add_folder("How", expand_by_default=False):
            if any(field.name == "components" for field in fields(task)):  # type: ignore[arg-type]
                usual = int(task.components)  # type: ignore[attr-defined]
                self._components = gui.add_slider("Components", 1, max(12, usual), 1, usual)
            for name, behaviour in task.behaviours().items():
                with gui.add_folder(f"Frames of {name}"):
                    for view in behaviour.views:
                        self._frames[name, view] = gui.add_checkbox(view, True)
        self._shapes = gui.add_checkbox("Show ellipsoids in the scene", False)
        self._shapes.on_update(page.guarded(self._draw))
        # Plotly is 5 MB for every browser: not before somebody wants it.
        self._plots = gui.add_checkbox("Plot what was learned", False)
        self._plots.on_update(page.guarded(self._plot))
        self._over_time = gui.add_folder("Which frames matter over time", visible=False)
        self._curves: viser.GuiPlotlyHandle | None = None
        self._frame_plot = FramePlot(gui, task)
        self._drawn: dict[str, Ellipsoids] = {}
        self._learned: Learned | None = None

    def refresh(self) -> None:
        """Say what is still to be shown."""
        missing = self._page.lessons.missing
        self._button.disabled = bool(missing)
        times = {name: "once more" if n == 1 else f"{n} times" for name, n in missing.items()}
        more = " and ".join(f"**{name}** {often}" for name, often in times.items())
        self._missing.content = f"Before it can learn, show it {more}." if more else ""

    def _draw(self) -> None:
        """Ellipsoids of the model in every frame, where the frames are now."""
        page, session = self._page, self._page.session
        shapes: dict[str, list[Ellipsoid]] = {}
        if self._shapes.value and session.models is not None:
            with session.lock:
                shapes = ellipsoids(session.task, session.models, session.going.state)
        for k, name in enumerate(shapes):
            if name not in self._drawn:
                red, green, blue = bytes.fromhex(PALETTE[k % len(PALETTE)][1:])
                self._drawn[name] = Ellipsoids(
                    page.server, f"/learned/{name}", (red, green, blue), 0.3
                )
        for name, drawn in self._drawn.items():
            drawn.draw(shapes.get(name, []))

    def show(self, learned: Learned) -> None:
        """Say what was learned."""
        self._learned = learned
        rows = []
        for name, count in learned.counts.items():
            whose = "yours" if name in learned.by_hand else "recorded"
            likelihood = learned.log_likelihood.get(name)
            words = "" if likelihood is None else f", log-likelihood {likelihood:.1f}"
            rows.append(f"**{name}** from {count} demonstrations ({whose}){words}")
        by_hand = "The robot performs it now: drag any part to push it." if learned.by_hand else ""
        self._said.content = "  \n".join([*rows, by_hand])
        self._plot()
        self._draw()

    def _plot(self) -> None:
        """When frames matter, and what they saw."""
        learned, wanted = self._learned, bool(self._plots.value)
        self._over_time.visible = wanted
        if learned is None or not wanted:
            self._frame_plot.show({})
            return
        task, gui = self._page.session.task, self._page.server.gui
        curves = plot_matters(matters(task, learned.models, learned.seen))
        if self._curves is None:
            with self._over_time:
                self._curves = gui.add_plotly(curves, config=CONFIG, aspect=1.0)
        self._curves.figure = curves
        self._frame_plot.show(learned.seen, learned.models)

    def _learn(self) -> None:
        page, session = self._page, self._page.session
        without: dict[str, list[str]] = {}
        for (name, view), box in self._frames.items():
            if not box.value:
                without.setdefault(name, []).append(view)
        self._button.disabled, self._button.label = True, "Learning ..."
        try:
            if self._components is not None:
                with session.lock:
                    session.set_fields(components=int(self._components.value))
            learned = page.lessons.learn(session.task, without)
        finally:
            self._button.label = "Learn from what was shown"
            self.refresh()
        with session.lock:
            session.set_models(learned.models)
        self.show(learned)
        if not self._plots.value:
            # Its callback plots.
            self._plots.value = True  # type: ignore[misc]  # mypy loses the setter of a generic base
