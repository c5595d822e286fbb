"""demo_IK_nullspace_TPGMM01: priorities of two hands, learned as frames (Eqs 41, 44, Fig. 11).

Look for: where new targets part too far, the hand that the teacher served first is served first.
"""

from functools import partial

import numpy as np

from tpsim import Gaussian, fit_tp_gmm, projection, two_armed

LEFT, RIGHT = two_armed((0.5,) * 5)
START = np.array([np.pi / 2, np.pi / 2, np.pi / 3, -np.pi / 2, -np.pi / 3])
I, STEP = np.eye(2), {"gain": 0.3, "clip": 0.05}
SHARES = {"left": 1.0, "compromise": 0.5, "right": 0.0}


def targets(way, steps=300):
    """Targets (T, 2, 2): both hands go out along ``way``, mirrored, and come back."""
    out = np.sin(np.linspace(0, np.pi, steps))[:, None] * way
    return np.stack([LEFT.position(START) + out * [-1, 1], RIGHT.position(START) + out], axis=1)


def frames_at(q, goals):
    """Left, right in the nullspace of left, left in the nullspace of right, right."""
    (J, x), (K, y) = ((arm.jacobian(q), arm.position(q)) for arm in (LEFT, RIGHT))
    return [
        projection.relative(J, q, x, I, goals[0], **STEP),
        projection.nullspace_relative(J, q, K, y, I, goals[1], **STEP),
        projection.nullspace_relative(K, q, J, x, I, goals[0], **STEP),
        projection.relative(K, q, y, I, goals[1], **STEP),
    ]


def move(act, goals):
    """What the frames see (4, T, 2) and the largest errors of both hands (2,) [m]."""
    path, seen = [START], []
    for now in goals:
        frames = frames_at(path[-1], now)
        path.append(act(path[-1], frames))
        seen.append([frame.to_local(path[-1]) for frame in frames])
    reached = np.stack([LEFT.position(path[1:]), RIGHT.position(path[1:])], axis=1)
    return list(np.swapaxes(seen, 0, 1)), np.linalg.norm(reached - goals, axis=2).max(axis=0)


def main() -> dict:
    figures = {}
    for name, share in SHARES.items():
        order = np.array([share, share, 1 - share, 1 - share])
        views, _ = move(lambda q, f, o=order: q + o @ [g.b - q for g in f], targets([0.5, 0.2]))
        model = fit_tp_gmm(views, 1, ridge=1e-5)
        prior = Gaussian(START, 100 * np.eye(5))  # the two hands leave one direction open
        adapt = partial(model.adapt, prior=prior)
        _, errors = move(lambda q, f, a=adapt: a(f).gaussians.mean[0], targets([0.4, 0.4]))
        figures[name] = {"left_mm": 1e3 * float(errors[0]), "right_mm": 1e3 * float(errors[1])}
    return figures


if __name__ == "__main__":
    print(main())
