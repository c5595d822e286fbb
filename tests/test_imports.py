"""`import tpsim` gives the mathematics, quickly, with numpy and scipy alone."""

import json
import subprocess
import sys

SCRIPT = """
import json, sys, time
start = time.perf_counter()
import numpy
numpy_took = time.perf_counter() - start
import tpsim
took = time.perf_counter() - start
print(json.dumps({"numpy": numpy_took, "tpsim": took, "modules": sorted(sys.modules)}))
"""


def imported():
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True, timeout=60
    )
    return json.loads(done.stdout)


def test_import_brings_no_simulator_and_no_plots():
    heavy = {"mujoco", "pinocchio", "mink", "dm_control", "matplotlib", "imageio", "sklearn"}
    roots = {name.partition(".")[0] for name in imported()["modules"]}
    assert not heavy & roots


def test_import_takes_less_than_half_a_second():
    """Numpy and scipy included; on a busy machine, in proportion to numpy's own import."""
    runs = [imported() for _ in range(3)]
    assert min(run["tpsim"] / max(0.5, 5 * run["numpy"]) for run in runs) < 1
