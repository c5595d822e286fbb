"""A small plot in a panel: what a frame saw of the demonstrations."""

import threading

import viser

from tpsim.play.seen import Seen, plot_seen
from tpsim.task.task import Models, Task

CONFIG = {"displayModeBar": False}
"""Of Plotly: there is no room for its buttons."""


ASPECT = 0.75
"""Height over width."""


class FramePlot:
    """A frame to choose, and what it saw.

    Parameters
    ----------
    gui : viser.GuiApi
    task : Task
    """

    def __init__(self, gui: viser.GuiApi, task: Task):
        self._gui, self._task = gui, task
        self._names = {
            f"{name}: {view}": (name, k)
            for name, behaviour in task.behaviours().items()
            for k, view in enumerate(behaviour.views)
        }
        self._chosen = gui.add_dropdown(
            "What it saw", tuple(self._names), visible=False, hint="In the frame's own coordinates"
        )
        self._chosen.on_update(lambda _: self._draw())
        self._folder = gui.add_folder(None)
        self._lock = threading.Lock()
        self._plot: viser.GuiPlotlyHandle | None = None
        self._seen: Seen = {}
        self._models: Models | None = None

    def show(self, seen: Seen, models: Models | None = None) -> None:
        """Plot these demonstrations, and the components that were learned from them."""
        self._seen, self._models = seen, models
        known = tuple(name for name, (behaviour, _) in self._names.items() if seen.get(behaviour))
        self._chosen.visible = bool(known)
        if known and self._chosen.options != known:
            self._chosen.options = known
        self._draw()

    def _draw(self) -> None:
        # Another choice is told in a thread of its own.
        with self._lock:
            self._draw_chosen()

    def _draw_chosen(self) -> None:
        name, k = self._names[self._chosen.value]
        seen = self._seen.get(name)
        if not seen:
            if self._plot is not None:
                self._plot.visible = False
            return
        view = list(self._task.behaviours()[name].views.values())[k]
        learned = None if self._models is None else self._models[name].frames[k]
        figure = plot_seen(seen, k, view.labels(self._task.stage.robot), learned)
        if self._plot is None:
            with self._folder:
                self._plot = self._gui.add_plotly(figure, config=CONFIG, aspect=ASPECT)
        self._plot.figure, self._plot.visible = figure, True
