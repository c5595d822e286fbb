"""Curves of the last seconds: error, force, stiffness, energy."""

from collections import deque

import numpy as np
import viser
from viser import uplot

from tpsim.play.session import Session
from tpsim.plot.style import PALETTE
from tpsim.world.impedance import Impedance, hand_stiffness

SAMPLES = 100
"""Points of a curve."""

FONT, HEIGHT = "10px sans-serif", 110
"""Of numbers at axes, and of a plot [pixel]."""


class Curves:
    """What is noted of a session ten times a second, and drawn beside its scene.

    Parameters
    ----------
    server : viser.ViserServer
    session : Session
    """

    def __init__(self, server: viser.ViserServer, session: Session):
        self._session = session
        self._goals = dict(session.task.goals())
        robot = session.world.robot
        self._series = {
            "Error [1 is allowed]": list(self._goals),
            "Force of hands [N]": ["force"],
            "Stiffest at hands [N/m]": list(robot.hands),
            "Energy in the tank [J]": ["tank"],
        }
        self._series = {title: names for title, names in self._series.items() if names}
        self._notes: deque[list[float]] = deque(maxlen=SAMPLES)
        self._panel = server.gui.add_panel()
        self._plots = []
        with self._panel.add_tab("Curves", viser.Icon.CHART_LINE):
            for title, names in self._series.items():
                self._plots.append(self._plot(server, title, names))
        self._panel.dock_left()
        self._panel.set_width(260)

    @staticmethod
    def _plot(server: viser.ViserServer, title: str, names: list[str]) -> viser.GuiUplotHandle:
        empty = tuple(np.zeros(2) for _ in range(1 + len(names)))
        lines = [
            uplot.Series(label=name, stroke=PALETTE[k % len(PALETTE)], width=2)
            for k, name in enumerate(names)
        ]
        return server.gui.add_uplot(
            empty,
            (uplot.Series(label="s"), *lines),
            title=title,
            scales={
                "x": uplot.Scale(time=False, auto=True),
                "y": uplot.Scale(range=(0.0, None)),
            },
            axes=(uplot.Axis(font=FONT, size=24), uplot.Axis(font=FONT, size=38, space=22)),
            legend=uplot.Legend(show=len(names) > 1, live=False),
            height=HEIGHT,
            padding=(8, 8, 0, 0),
        )

    def note(self) -> None:
        """Note a moment; the session's lock must be held."""
        session = self._session
        state, command = session.going.state, session.going.command
        row = [session.time]
        for goal in self._goals.values():
            row.append(float(np.linalg.norm(goal.view(state).value)) / goal.within)
        forces = [np.linalg.norm(pull.drag.wrench[:3]) for pull in session.pulls.values()]
        row.append(float(sum(forces)))
        for site in session.world.robot.hands.values():
            stiff = 0.0
            if isinstance(command, Impedance):
                K = hand_stiffness(state.jacobian(site), command.stiffness)[:3, :3]
                stiff = float(np.linalg.eigvalsh(K)[-1])
            row.append(stiff)
        row.append(float(np.nan_to_num(session.going.drive.energies.tank, posinf=0.0)))
        if self._notes and row[0] < self._notes[-1][0]:
            self._notes.clear()
        self._notes.append(row)

    def draw(self) -> None:
        """Show what was noted; while it is taught, errors of the task say nothing."""
        if self._goals:
            self._plots[0].visible = self._session.mode == "perform"
        if len(self._notes) < 2:
            return
        columns = np.array(self._notes).T
        first = 1
        for plot, names in zip(self._plots, self._series.values(), strict=True):
            plot.data = (columns[0], *columns[first : first + len(names)])
            first += len(names)
