"""Draw docs/perception.png: where transfer ends when a camera sees the docks, and what fades.

Run it after its numbers have changed: ``python docs/draw_perception.py`` (some minutes).
"""

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib.figure import Figure

from tpsim.plot.style import PALETTE, panels, save
from tpsim.task.task import draw_situation
from tpsim.task.verbs import learn, perform, teach
from tpsim.tasks.transfer.study import HIDDEN
from tpsim.tasks.transfer.task import SEEN, Transfer
from tpsim.world.perception import Perception
from tpsim.world.plant import Plant

SITUATIONS = 6
HIDING = (("end", *HIDDEN),)
CAMERAS = {
    "told": None,
    "30 Hz": {"rate": 30.0},
    "20 Hz": {"rate": 20.0},
    "10 Hz": {"rate": 10.0},
    "20 Hz, hidden for 3 s": {"rate": 20.0, "occluded": HIDING},
}


def ended(task, trial):
    """Distance [mm] and angle [deg] of the hand from its place in the second dock, at the end."""
    poses = {name: trial.pose(name) for name in ("start", "end")}
    errors = []
    for k in range(-50, 0, 10):
        now = {name: pose.at(k) for name, pose in poses.items()}
        state = task.stage.robot.at(trial["q"][k], objects=now)
        parts = (SEEN["end", part](state).value for part in ("position", "orientation"))
        errors.append([np.linalg.norm(part) for part in parts])
    return np.max(errors, axis=0) * [1e3, 180 / np.pi]


def main():
    """Two panels: end errors, and the stiffness of the hand over time."""
    task = Transfer()
    models = learn(task, teach(task, seed=0))
    figure = Figure()
    ends, stiff = panels(figure, 1, 2, kind="curve", size=(4.6, 3.0))
    for k, (name, camera) in enumerate(CAMERAS.items()):
        trials = []
        for i in range(SITUATIONS):
            seen = None if camera is None else Perception(**camera, seed=i)
            situation = draw_situation(task, 0, i)
            trials.append(perform(task, models, situation, plant=Plant(perception=seen)))
        errors = np.array([ended(task, trial) for trial in trials])
        mean, worst = errors.mean(0).round(2), errors.max(0).round(2)
        print(f"{name}: mean {mean[0]} mm, {mean[1]} deg; worst {worst[0]} mm, {worst[1]} deg")
        ends.plot(errors[:, 0], errors[:, 1], "o", color=PALETTE[k % 6], label=name)
        if name in ("told", "20 Hz", "20 Hz, hidden for 3 s"):
            K = np.trace(trials[0]["left_hand_stiffness"], axis1=1, axis2=2) / 3
            stiff.plot(trials[0].time, K, color=PALETTE[k % 6], label=name)
    ends.set(xlim=(0, 3), ylim=(0, 1.5), xlabel="end error [mm]", ylabel="end error [deg]")
    ends.legend(fontsize=7)
    stiff.axvspan(*HIDDEN, color="0.9", zorder=0)
    stiff.set(xlabel="time [s]", ylabel="mean stiffness of the hand [N/m]")
    save(figure, Path(__file__).with_name("perception.png"))


if __name__ == "__main__":
    main()
