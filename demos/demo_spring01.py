"""demo_spring01: influence of the damping ratio in mass-spring-damper systems.

Look for: below the ratio 1 the mass overshoots its target, above it creeps. The optimal
controller of Section 6 has the ratio 1 / sqrt(2), which overshoots by 4 %.
"""

import numpy as np

from tpsim import damping_of, spring_damper

RATIOS = (0.2, 1 / np.sqrt(2), 1.0, 2.0)
STIFFNESS, DT = 50.0, 0.01


def solve():
    """Paths (T,) to a target at 1, one for each damping ratio."""
    return {
        ratio: spring_damper(
            np.ones((200, 1)), STIFFNESS, damping_of(STIFFNESS, ratio), DT, [0.0, 0.0]
        ).states[:, 0]
        for ratio in RATIOS
    }


def main() -> dict:
    return {f"overshoot_{ratio:.2f}": float(max(0.0, x.max() - 1)) for ratio, x in solve().items()}


def draw() -> None:
    import matplotlib.pyplot as plt

    for ratio, x in solve().items():
        plt.plot(DT * np.arange(len(x)), x, label=f"ratio {ratio:.2f}")
    plt.xlabel("time [s]")
    plt.ylabel("position [m]")
    plt.legend()
    plt.show()


if __name__ == "__main__":
    print(main())
    draw()
