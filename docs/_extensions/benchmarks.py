"""The page of benchmarks, made from what ``tpsim bench --json`` gave.

``tpsim bench --json | python docs/_extensions/benchmarks.py`` records the figures anew in
``docs/benchmarks.json``, with the machine that gave them.
"""

import json
import os
import platform
import sys
from datetime import date
from importlib.metadata import version
from pathlib import Path

RECORDED = Path(__file__).resolve().parents[1] / "benchmarks.json"
UNITS = {"_ms": "ms", "_us": "µs", "_per_s": "1/s"}

TITLES = {
    "learning": "Learning",
    "retrieval": "Retrieval",
    "control": "Control",
    "simulation": "Simulation",
}

MEANING = {
    "fit_ms": "TP-GMM, N = 2000, P = 3, K = 5: the whole fit",
    "fit_iterations": "its EM iterations",
    "em_iteration_ms": "one EM iteration",
    "sklearn_fit_ms": "scikit-learn, GaussianMixture on the same data: the whole fit",
    "sklearn_iteration_ms": "scikit-learn: one EM iteration",
    "sklearn_over_tpsim_iteration": "an iteration of scikit-learn over one of tpsim",
    "adapt_us": "adapt the TP-GMM to new frames",
    "mfa_94_iteration_ms": "one EM iteration of factor analysers in 94 dimensions",
    "growth_200000_factor": "time per sample with 200 000 samples over that with 2000",
    "gmr_200_steps_ms": "GMR with covariance, 200 steps",
    "gmr_one_point_us": "GMR with covariance, one point",
    "gmr_one_point_moved_frame_us": "TP-GMR, one point after a frame has moved",
    "pose_fit_ms": "TP-GMM of poses, R(1) * R(3) * S3, N = 2000, P = 3, K = 5: the whole fit",
    "pose_fit_iterations": "its EM iterations on the manifold",
    "pose_adapt_us": "adapt it to new frames",
    "pose_gmr_one_point_moved_frame_us": "TP-GMR of poses, one point after the frames have moved",
    "trajectory_800_steps_ms": "trajectory-GMM, 800 steps",
    "trajectory_8000_steps_ms": "trajectory-GMM, 8000 steps",
    "trajectory_growth_for_10_times_the_steps": "its time for ten times the steps",
    "recursive_1000_ms": "LQT, recursive, 1000 steps",
    "batch_1000_ms": "LQT, batch, 1000 steps",
    "rollout_1000_ms": "roll-out of its controller, 1000 steps",
    "covariance_1000_ms": "covariance of its plan, 1000 steps",
    "recursive_factor_10": "recursive LQT for ten times the steps",
    "batch_factor_10": "batch LQT for ten times the steps",
    "rollout_factor_10": "roll-out for ten times the steps",
    "covariance_factor_10": "covariance for ten times the steps",
    "horizon_50_us": "LQT over a receding horizon of 50 steps",
    "regulator_us": "infinite-horizon LQR by its Riccati equation",
    "impedance_7_us": "closed-form stiffness and damping, 7 joints",
    "relative_6x7_us": "a frame of Eq. (41), 6 x 7 Jacobian",
    "nullspace_relative_6x7_us": "a frame of Eq. (44), 6 x 7 Jacobians",
    "film_frame_ms": "one frame of a film",
}

TASK = {
    "_physics_factor": "physics alone, faster than real time",
    "_realtime_factor": "physics, control at 1 kHz and recording, faster than real time",
    "_environment_steps_per_s": "steps of its dm_env environment",
    "_tank_percent": "what the energy tank adds to a step, per cent",
}
"""What is measured of every task."""

_TASK_UNITS = {"_environment_steps_per_s": " 1/s", "_tank_percent": " %"}


def page() -> str:
    """Tables of all figures as Markdown."""
    recorded = json.loads(RECORDED.read_text(encoding="utf-8"))
    lines = [f"Recorded {recorded['date']} on {recorded['machine']}.", ""]
    for area, figures in recorded["figures"].items():
        lines += [f"## {TITLES.get(area, area)}", ""]
        plain = {name: value for name, value in figures.items() if name in MEANING}
        if plain:
            lines += ["| what | figure |", "| --- | ---: |"]
            lines += [f"| {MEANING[n]} | {_written(n, v)} |" for n, v in plain.items()] + [""]
        lines += _tasks({n: v for n, v in figures.items() if n not in MEANING})
    return "\n".join(lines)


def _tasks(figures: dict[str, float]) -> list[str]:
    """One row for every task."""
    rows: dict[str, dict[str, float]] = {}
    for name, value in figures.items():
        kind = next(ending for ending in TASK if name.endswith(ending))
        rows.setdefault(name.removesuffix(kind), {})[kind] = value
    if not rows:
        return []
    # What was not yet measured when the figures were recorded has no column.
    kinds = {
        kind: words for kind, words in TASK.items() if any(kind in row for row in rows.values())
    }
    lines = [f"| task | {' | '.join(kinds.values())} |", "| --- |" + " ---: |" * len(kinds)]
    for task, row in rows.items():
        cells = [f"{row[kind]:.0f}{_TASK_UNITS.get(kind, 'x')}" for kind in kinds]
        lines.append(f"| `{task.replace('_', '-')}` | {' | '.join(cells)} |")
    return [*lines, ""]


def _written(name: str, value: float) -> str:
    unit = next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")
    return f"{value:.3g}".replace("e+0", "e") + f" {unit}".rstrip()


def machine() -> str:
    """Words for this machine: processors, system, versions, and how busy it is."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "mujoco"))
    return (
        f"{os.cpu_count()} processors ({_processor()}), {platform.system()}, "
        f"Python {platform.python_version()}, {packages}; "
        f"load {os.getloadavg()[0]:.1f} while measuring"
    )


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    names = {line.partition(":")[2].strip() for line in lines if line.startswith("model name")}
    return ", ".join(sorted(names)) or platform.machine()


if __name__ == "__main__":
    answer = {
        "date": date.today().isoformat(),
        "machine": machine(),
        "figures": json.load(sys.stdin),
    }
    RECORDED.write_text(json.dumps(answer, indent=1) + "\n", encoding="utf-8")
