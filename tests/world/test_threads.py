"""The same bytes on any number of cores, in any folder, under any locale."""

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

import tpsim
from tpsim import fit_tp_gmm, lab
from tpsim.study.reference import load_study
from tpsim.world.threads import linear_algebra, one_thread

TOY = Path(__file__).parents[1] / "study" / "toy.py"
SCRIPT = """
import locale, sys
from pathlib import Path
from tpsim import lab
locale.setlocale(locale.LC_ALL, "")
study = lab.load_study(sys.argv[1])
if __name__ == "__main__":
    plan = lab.Plan(seed=3, situations=1, pushes=1)
    lab.run(study, plan, Path("made"), workers=int(sys.argv[2]), video=False)
"""


def threads():
    return {pool["num_threads"] for pool in threadpool_info()}


def test_blocks_are_nested_and_leave_what_was():
    with threadpool_limits(2):
        before = threads()
        with one_thread(), one_thread():
            assert threads() == {1}
            assert "1 thread" in linear_algebra() and "threads" not in linear_algebra()
        assert threads() == before
        assert one_thread()(threads)() == {1}
        assert threads() == before


def test_blocks_of_several_threads_count_whoever_comes_first_and_leaves_last():
    entered, other = Event(), ThreadPoolExecutor(1)

    def first():
        with one_thread():
            entered.wait(10)

    def last():
        with one_thread():
            entered.set()
            leaving.result(10)
            return threads()

    with threadpool_limits(2), other, ThreadPoolExecutor(1) as third:
        before = threads()
        for _ in range(2):
            leaving = other.submit(first)
            assert third.submit(last).result(10) == {1}
            assert threads() == before
            assert one_thread()(threads)() == {1}
            assert other.submit(one_thread()(threads)).result(10) == {1}
            assert threads() == before
            entered.clear()


def test_learning_a_large_model_has_the_bits_of_one_thread():
    rng = np.random.default_rng(0)
    data = rng.normal(size=(4000, 60)) @ rng.normal(size=(60, 60))
    digests = set()
    for count in (1, 2):
        with threadpool_limits(count), one_thread():
            digests.add(hashlib.sha256((data.T @ data).tobytes()).hexdigest())
    assert len(digests) == 1


def test_teacher_fit_and_controller_see_one_thread():
    study, seen = load_study(f"{TOY}:study"), {}

    class Spy(type(study.task)):
        def lesson(self, world, rng):
            seen["lesson"] = threads()
            return super().lesson(world, rng)

        def behaviours(self):
            (behaviour,) = super().behaviours().values()
            return {"bring": replace(behaviour, fit=self.fit)}

        def fit(self, demonstrations):
            seen["fit"] = threads()
            return fit_tp_gmm(demonstrations, 1)

        def controller(self, world, models, situation):
            seen["controller"] = threads()
            return super().controller(world, models, situation)

    with threadpool_limits(2):
        task = Spy()
        taught = lab.teach(task, 1)
        models = lab.learn(task, {"bring": taught["bring"] * 2})
        lab.perform(task, models, lab.draw_situation(task, 0, 0))
    assert seen == {key: {1} for key in ("lesson", "fit", "controller")}


def test_a_run_has_the_same_bytes_in_any_environment(tmp_path):
    """Teaching, learning and trials: threads, locale, time zone, folder and workers change none."""
    package = str(Path(tpsim.__file__).parents[1])
    made = []
    for number, (cores, workers, words) in enumerate([("1", 1, "C"), ("4", 2, "C.UTF-8")]):
        folder = tmp_path / f"{number} é"
        folder.mkdir()
        given = {"OMP_NUM_THREADS": cores, "OPENBLAS_NUM_THREADS": cores, "LC_ALL": words}
        given |= {"PYTHONPATH": package, "TZ": f"UTC{number}", "PYTHONHASHSEED": str(number)}
        subprocess.run(
            [sys.executable, "-c", SCRIPT, f"{TOY}:study", str(workers)],
            cwd=folder,
            env=os.environ | given,
            check=True,
            capture_output=True,
            timeout=120,
        )
        run = folder / "made"
        made.append(
            {
                str(file.relative_to(run)): file.read_bytes()
                for file in sorted(run.rglob("*"))
                if file.is_file() and file.name not in ("run.json", "report.html")
            }
        )
    first, second = made
    assert {"model-bring.npz", "scene.xml", "trial-000000.npz"} <= first.keys()
    assert any(name.startswith("demonstrations") for name in first)
    assert first == second
