"""demo_IK_pointing_TPGMM01: point at two objects, then return to a posture (Eqs 40-42, Fig. 10).

Look for: the product of four frames knows when which of them counts, for moving objects too.
"""

import numpy as np

from tpsim import PlanarChain, Regression, fit_tp_gmm, projection
from tpsim.control.projection import nullspace, pseudoinverse

ARM, START, T, DT = PlanarChain((0.2, 0.2, 0.2)), np.array([0.0, np.pi / 2, 0.0]), 150, 0.02
J, TIME = ARM.orientation_jacobian(START), DT * np.arange(T)[:, None]


def angles(q, objects):  # at which the hand sees them, within half a turn of its own
    own, (x, y) = ARM.orientation(q), (objects - ARM.position(q)).T
    return own + np.mod(np.arctan2(y, x) - own + np.pi, 2 * np.pi) - np.pi


def teach(t, q, objects):
    goal = [*angles(q, objects), START.sum()][3 * t // T]
    return q + 0.15 * (nullspace(J) @ (START - q) + pseudoinverse(J) @ [goal - q.sum()])


def reproduce(model, t, q, objects):
    to = [projection.relative(J, q, [q.sum()], np.eye(1), [a]) for a in angles(q, objects)]
    frames = [projection.nullspace_joint(J, q), *to, projection.absolute(J, q, [q.sum()])]
    return Regression.of(model.adapt([f.with_input() for f in frames])).at(TIME[t]).mean


def move(act, rng, speed=0.0):
    objects = np.array([[0.9, 0.4], [-0.7, 0.6]]) + rng.uniform(-0.1, 0.1, (2, 2))
    path, errors = [START], []
    for t in range(T):
        objects[1, 1] += speed * DT
        errors.append(path[-1].sum() - angles(path[-1], objects))
        path.append(act(t, path[-1], objects))
    return np.array(path[:-1]), np.array(errors)


def main(plot=lambda *line, **style: None) -> dict:
    rng, views, figures = np.random.default_rng(0), [], {}
    for q, errors in (move(teach, rng) for _ in range(6)):
        seen = q @ nullspace(J), errors[:, :1], errors[:, 1:], ARM.orientation(q)
        views.append([np.hstack([TIME, view]) for view in seen])
    model = fit_tp_gmm([np.vstack(view) for view in zip(*views, strict=True)], 6, start="time")
    for name, speed in (("resting", 0.0), ("moving", 0.1)):
        q, errors = move(lambda *now: reproduce(model, *now), rng, speed)
        figures[f"first_deg_{name}"] = float(np.rad2deg(np.abs(errors[35:50, 0]).mean()))
        figures[f"second_deg_{name}"] = float(np.rad2deg(np.abs(errors[85:100, 1]).mean()))
        figures[f"posture_rad_{name}"] = float(np.abs(q[-1] - START).max())
        plot(*ARM.points(q[::10]).transpose(2, 1, 0), color="0.6")
    return figures


if __name__ == "__main__":
    import matplotlib.pyplot as plt

    print(main(plt.plot))
    plt.show()
