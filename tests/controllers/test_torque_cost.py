"""What springs may pull beside brakes, and what counts as an arm that cannot move its hand."""

import numpy as np

from tpsim import lab
from tpsim.controllers import torque_cost
from tpsim.controllers.torque_cost import share_within

HOME = (0.3, 0.8, 0.9, -0.5, 0.7, 0.4)

AXES = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1")

LINK = """<body pos="0 0 .25"><joint name="j{k}" axis="{axis}" armature="{i}"/>
  <geom type="capsule" fromto="0 0 0 0 0 .25" size=".02" mass=".1" contype="0" conaffinity="0"/>"""

ARM = (
    "<mujoco><worldbody>"
    + "".join(LINK.replace("{k}", str(k)).replace("{axis}", AXES[k]) for k in range(6))
    + '<site name="tip" pos="0.05 0 .25"/>'
    + "</body>" * 6
    + "</worldbody><actuator>"
    + "".join(f'<motor joint="j{k}" ctrlrange="-40 40"/>' for k in range(6))
    + "</actuator></mujoco>"
)
"""Six hinges of armature i [kg m^2]."""


def test_springs_and_brakes_together_stay_within_the_bound_and_brakes_are_no_burden():
    rng = np.random.default_rng(0)
    for _ in range(300):
        weights = rng.uniform(0.01, 1.0, 6)
        pull, brake = 5 * rng.normal(size=(2, 6))
        brake *= rng.uniform(0, 1) / np.sqrt(brake**2 @ weights)
        share, size = share_within(pull, brake, weights), pull**2 @ weights
        # At rest the pull alone is bounded; a brake never lessens what it may be.
        at_rest = share_within(pull, 0 * brake, weights)
        np.testing.assert_allclose(at_rest, min(1.0, size**-0.5))
        assert at_rest * (1 - 1e-9) <= share <= 1.0
        # Who pushes it away from its movement adds the brake, and no more.
        assert (share * pull - brake) ** 2 @ weights <= 1 + 1e-9 or np.isclose(share, at_rest)


def test_a_movement_at_the_speed_that_is_asked_for_is_not_cut():
    """Springs of a heavy arm work against its own brakes: all of them are needed."""
    weights, brake = np.full(3, 0.25), np.array([30.0, -12.0, 4.0])
    assert share_within(brake, brake, weights) == 1.0
    assert share_within(brake, 0 * brake, weights) < 0.1


def test_what_is_usual_for_a_heavy_arm_is_not_singular():
    def least(inertia):
        arm = lab.Robot.from_mjcf(ARM.format(i=inertia), {"hand": "tip"}, home=HOME)
        postures = np.array([HOME, HOME[::-1]])
        return torque_cost.least_mobility(arm, slice(0, 6), "tip", postures), arm.at(HOME)

    light, _ = least(0.1)
    assert light == torque_cost.SINGULAR
    heavy, state = least(20.0)
    assert heavy < torque_cost.SINGULAR
    J = state.jacobian("tip")
    felt = torque_cost.felt_inertia(state.mass, J, heavy)
    np.testing.assert_allclose(felt @ torque_cost.mobility(state.mass, J), np.eye(6), atol=1e-6)


def test_directions_in_which_an_arm_never_moves_make_no_arm_singular():
    """Three hinges in a plane: mobility out of it is zero, up to rounding of either sign."""
    joints = "".join(LINK.format(k=k, axis="0 1 0", i=0.1) for k in range(3))
    text = (
        "".join(("<mujoco><worldbody>", joints, '<site name="tip" pos="0 0 .25"/>', "</body>" * 3))
        + "</worldbody><actuator>"
    )
    text += "".join(f'<motor joint="j{k}" ctrlrange="-40 40"/>' for k in range(3))
    arm = lab.Robot.from_mjcf(text + "</actuator></mujoco>", {"hand": "tip"}, home=HOME[:3])
    postures = np.array([HOME[:3], HOME[1:4]])
    least = torque_cost.least_mobility(arm, slice(0, 3), "tip", postures)
    assert 1e-3 < least <= torque_cost.SINGULAR


def test_springs_of_an_arm_that_is_held_overcome_its_friction_but_are_no_stronger_than_usual():
    for rubs, share in ((0.0, 0.16), (0.4, 0.16 + 0.01 * 6**0.5), (4.0, torque_cost.STRENGTH)):
        text = ARM.replace("{i}", "0.1").replace("<joint ", f'<joint frictionloss="{rubs}" ')
        robot = lab.Robot.from_mjcf(text, hands={"hand": "tip"})
        np.testing.assert_allclose(torque_cost.held(robot, slice(0, 6)), share)
