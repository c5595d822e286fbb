"""Draw docs/teacher.png: what the human demonstrator's hand does, beside what is known of people.

Run it after its numbers have changed: ``python docs/draw_teacher.py``.
"""

from dataclasses import replace
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib.figure import Figure
from scipy.signal import welch

from tpsim.plot.style import PALETTE, panels
from tpsim.world.people.care import EVERYTHING
from tpsim.world.people.demonstrator import FIRM, HUMAN
from tpsim.world.people.script import wandering
from tpsim.world.people.sight import foreseen

H, SECONDS = 1e-3, 300


def spectrum(variation, care=None):
    """Amplitude density of one axis, mm per root of Hz."""
    still = np.zeros((round(SECONDS / H), 6))
    moved, _ = wandering(still, H, np.random.default_rng(0), variation, care)
    f, power = welch(1e3 * moved, 1 / H, nperseg=2**14, axis=0)
    return f[1:], np.sqrt(power.mean(1))[1:], 1e3 * moved.std()


def main():
    """Two panels: the spectrum of the hand, and how late it follows an object."""
    figure = Figure()
    axes = panels(figure, 1, 2, kind="curve", size=(4.6, 3.2))
    kinds = {
        "human": (HUMAN.variation, None),
        "human, where it matters": (HUMAN.variation, EVERYTHING),
        "firm": (FIRM.variation, None),
    }
    for colour, (name, (variation, care)) in zip(PALETTE, kinds.items(), strict=False):
        f, density, rms = spectrum(variation, care)
        _, _, tremor = spectrum(replace(variation, drift=0.0), care)
        axes[0].loglog(f, density, color=colour, label=f"{name}: {rms:.2f} mm, fast {tremor:.2f}")
        print(f"{name}: rms {rms:.3f} mm, of which fast {tremor:.3f} mm")
    axes[0].axvspan(8, 12, color="0.9", zorder=0)
    axes[0].set(xlim=(0.1, 30), ylim=(1e-3, 20), xlabel="frequency [Hz]")
    axes[0].set_ylabel("hand's wandering [mm/$\\sqrt{Hz}$]")
    axes[0].legend(fontsize=7)
    t = np.arange(0, 6, H)
    for colour, delay in zip(PALETTE, (0.15, 0.2, 0.25), strict=False):
        worst = []
        periods = np.geomspace(1, 8, 20)
        for period in periods:
            path = 0.1 * np.sin(2 * np.pi * t / period)[:, None]
            worst.append(1e3 * np.abs(path - foreseen(path, H, delay))[2000:].max())
        axes[1].semilogy(periods, worst, color=colour, label=f"{delay:.2f} s late")
    axes[1].set(xlabel="period of an object that swings 100 mm to both sides [s]")
    axes[1].set_ylabel("largest error of what is expected [mm]")
    axes[1].legend(fontsize=7)
    figure.savefig(Path(__file__).with_name("teacher.png"), dpi=130)


if __name__ == "__main__":
    main()
