"""A recorded run in the page: its trials, moment by moment."""

import threading
import time

import mujoco
import numpy as np
import viser

from tpsim.errors import RecordingError
from tpsim.play.stage import Picture, Stage
from tpsim.robot.home import put
from tpsim.study.files.about import Performed, read_about
from tpsim.study.files.run import Run
from tpsim.world.recorded_place import put_object
from tpsim.world.trial import Trial
from tpsim.world.world import World

FRAMES = 30.0
"""Pictures per second while it plays."""


class Scrubbed:
    """Pictures of recorded trials.

    Parameters
    ----------
    world : World
    """

    def __init__(self, world: World):
        self._model = world.model
        self._data = mujoco.MjData(self._model)
        put(self._model, self._data.qpos, world.description.fixed)
        self._joints = [self._model.joint(name).qposadr[0] for name in world.description.joints]

    def picture(self, trial: Trial, sample: int) -> Picture:
        """What a trial looked like at a sample."""
        data, model = self._data, self._model
        data.qpos[self._joints] = trial["q"][sample]
        for name, (positions, quaternions) in trial.objects.items():
            pose = np.concatenate((positions[sample], quaternions[sample]))
            put_object(model, data, name, pose)
        mujoco.mj_kinematics(model, data)
        pulls = []
        for person in trial.channels.people:
            point, wrench = trial[f"{person}_point"][sample], trial[f"{person}_wrench"][sample]
            pulls.append((point, wrench[:3]))
        stiffness = [
            (trial[f"{hand}_position"][sample], trial[f"{hand}_stiffness"][sample])
            for hand in trial.channels.hands
        ]
        mocap = data.mocap_pos.copy(), data.mocap_quat.copy()
        return Picture(data.xpos.copy(), data.xmat.copy(), mocap, pulls, None, stiffness)


class RecordedPage:
    """The page of a run: trials, a timeline, speeds.

    Parameters
    ----------
    server : viser.ViserServer
    run : Run

    Raises
    ------
    RecordingError
        If the folder holds no trials.
    """

    def __init__(self, server: viser.ViserServer, run: Run):
        self._run, self._files = run, run.files()
        if not self._files:
            raise RecordingError(f"{run.folder} holds no trials; give a run's folder")
        self.server, self._ended, self._lock = server, threading.Event(), threading.Lock()
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        server.gui.main_panel.dock_right()
        self.stage = Stage(server, run.world, lambda *_: None)
        self._scrubbed = Scrubbed(run.world)
        names = tuple(f"{k}: {self._label(k)}" for k in range(len(self._files)))
        gui = server.gui
        self._trials = gui.add_dropdown("Trial", names)
        self._trials.on_update(lambda _: self._open())
        self._time = gui.add_slider("Time [s]", 0.0, 1.0, 0.01, 0.0)
        self._time.on_update(lambda _: self._draw())
        self._plays = gui.add_checkbox("Play", True)
        self._speed = gui.add_slider("Speed", 0.1, 4.0, 0.1, 1.0)
        self._said = gui.add_markdown("")
        self.trial = run.load(0)
        self._open()
        self._painter = threading.Thread(target=self._paint, name="tpsim page", daemon=True)
        self._painter.start()

    def is_alive(self) -> bool:
        """Whether it still draws."""
        return self._painter.is_alive()

    def close(self) -> None:
        """Stop drawing."""
        self._ended.set()
        self._painter.join()

    def _label(self, number: int) -> str:
        about = read_about(self._run.load(number), self._files[number])
        if not isinstance(about, Performed):
            return about.behaviour
        condition = about.condition
        return f"{condition.label}, {condition.controller}, {condition.situation.index}"

    def _open(self) -> None:
        with self._lock:
            self.trial = self._run.load(int(self._trials.value.partition(":")[0]))
            self._time.max = max(float(self.trial.time[-1]), 0.01)
            self._said.content = f"outcome: **{self.trial.outcome}**"
        self._at(0.0)
        self._draw()

    def _at(self, time: float) -> None:
        """Put the timeline somewhere."""
        self._time.value = time  # type: ignore[misc]  # mypy loses the setter of a generic base

    def _draw(self) -> None:
        with self._lock:
            trial = self.trial
            sample = int(np.searchsorted(trial.time, float(self._time.value), side="right")) - 1
            self.stage.draw(self._scrubbed.picture(trial, max(sample, 0)), stiffness=True)

    def _paint(self) -> None:
        before = time.monotonic()
        while not self._ended.wait(1 / FRAMES):
            passed, before = time.monotonic() - before, time.monotonic()
            if self._plays.value:
                later = float(self._time.value) + float(self._speed.value) * passed
                end = float(self._time.max)
                self._at(round(later, 3) if later <= end else 0.0)
                self._draw()
