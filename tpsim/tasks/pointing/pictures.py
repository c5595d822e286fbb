"""Pictures of the study of pointing: sections of its report, sequences of its film."""

from functools import partial
from typing import cast

import numpy as np

from tpsim.film.clip import Clip
from tpsim.gaussian import Gaussian
from tpsim.learning.tp_gmm import TPGMM
from tpsim.study import plot
from tpsim.study.record import Records
from tpsim.study.report import Picture, Section
from tpsim.study.study import Lab
from tpsim.tasks.pointing.measures import RECOVERED, angle
from tpsim.tasks.pointing.pointers import OBJECTS
from tpsim.tasks.pointing.task import Pointing
from tpsim.tasks.pointing.teacher import PHASES

_LABELS = {
    "unpushed": "objects at rest",
    "pushed": "pushed",
    "moving": "moving",
    "moving pushed": "moving, pushed",
    "jump": "jumping",
}


def sections(records: Records) -> list[Section]:
    """Angles to both objects over time, and the learned precision of the frames."""
    groups = records.groups(_LABELS)
    shown = []
    for name in OBJECTS if groups else ():
        start, end = PHASES[name]
        text = (
            f"Angle between the arm's axis and the way to the {name} object, which is to be "
            f"pointed at from {start:g} s to {end:g} s. Thin lines are trials, the thick one "
            "is their median."
        )
        figure = plot.panels(
            groups, partial(angle, name=name), label="angle [deg]", limit=RECOVERED
        )
        shown.append(Section(f"Pointing at the {name} object", text, [Picture(figure)]))
    names = list(cast(Pointing, records.task).pointer.views)
    return shown + [_frames(model, names) for model in records.models.values()]


def _frames(model: TPGMM, names: list[str]) -> Section:
    rows = [
        {"component": k + 1, "time [s]": model.frames[0].mean[k, 0]}
        | {
            f"{name} [deg]": float(np.degrees(_spread(gaussian, k)))
            for name, gaussian in zip(names, model.frames, strict=True)
        }
        for k in range(model.components)
    ]
    text = (
        "Standard deviation that remains in every frame once the time is known: small where "
        "the teacher was precise. The arm is stiff there and soft elsewhere."
    )
    return Section("What the demonstrations say", text, table=rows)


def _spread(gaussian: Gaussian, k: int) -> float:
    """Root mean square deviation of a component's view when the time is known."""
    rest = gaussian[k].condition([gaussian.mean[k, 0]], [0]).covariance
    return float(np.sqrt(np.trace(rest) / len(rest)))


def clips(lab: Lab, records: Records) -> list[Clip]:
    """A demonstration, moving objects, a jump, and a push in each phase."""
    camera = cast(Pointing, lab.task).pointer.camera
    shown = [
        Clip.of(
            lab.world,
            trials[0],
            "Demonstration",
            "the arm is led by hand",
            camera=camera,
            speed=2.0,
        )
        for trials in lab.taught.values()
        if trials
    ]
    for label, subtitle in (
        ("moving", "the objects move while the arm points"),
        ("jump", "each object jumps while it is pointed at"),
        ("moving pushed", "the objects move, and a person pushes"),
    ):
        if found := records.select(label):
            trial = found[-1].trial
            shown.append(Clip.of(lab.world, trial, "Reproduction", subtitle, camera=camera))
    return shown
