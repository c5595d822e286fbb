import pytest

from tpsim.errors import ArgumentError
from tpsim.robot.intake import take_in

_ONE = """
<mujoco><worldbody><body name="b"><joint name="j" axis="0 1 0"{joint}/>
<geom type="capsule" fromto="0 0 0 1 0 0" size="0.05" mass="1"/><site name="s" pos="1 0 0"/>
</body></worldbody><actuator>{actuators}</actuator></mujoco>"""
_MOTOR = '<motor joint="j" ctrlrange="-9 9"/>'


def _changed(old, new):
    return _ONE.format(actuators=_MOTOR, joint="").replace(old, new)


@pytest.mark.parametrize(
    ("text", "arguments", "message"),
    [
        (_changed("", ""), {"hands": {}}, "hands is empty.*sites are s"),
        (
            _changed("", ""),
            {"hands": {"h": "x"}},
            "hand 'h' is at 'x', which is no site; the sites are s",
        ),
        (
            _changed('<joint name="j" axis="0 1 0"/>', "").replace(_MOTOR, ""),
            {},
            "no joint moves hand 'h'.*joints are none",
        ),
        (
            _changed('axis="0 1 0"', 'type="ball"').replace(_MOTOR, ""),
            {},
            "joint 'j' of the arm is a ball joint",
        ),
        (
            _changed('axis="0 1 0"', 'type="free"').replace(_MOTOR, ""),
            {},
            "base is free .joint 'j'.: fix it",
        ),
        (_changed('ctrlrange="-9 9"', ""), {}, "no torque limit for j: pass torque_limit="),
        (_changed("", ""), {"torque_limit": {"k": 3}}, "names 'k', which is no arm joint; .* j"),
        (_changed("", ""), {"torque_limit": {"(": 3}}, "no regular expression"),
        (_changed("", ""), {"torque_limit": "much"}, "torque_limit is 'much', but must be"),
        (_changed("", ""), {"torque_limit": (1, 2)}, r"shape \(2,\), but there are 1 arm joints"),
        (_changed("", ""), {"velocity_limit": -1}, "velocity_limit of j must be positive"),
        (_changed("", ""), {"home": {"k": 0}}, "home names k, but the robot's joints are j"),
        (_changed("", ""), {"home": (0, 0)}, "home has shape"),
        (_changed("", ""), {"home": "up"}, "home is 'up', but must be"),
        (
            _changed('axis="0 1 0"', 'axis="0 1 0" range="-9 9"'),
            {"home": [1]},
            r"puts joint 'j' at 1, outside its range \[-0.15708, 0.15708\]",
        ),
        (
            _changed("-9 9", "-2 2"),
            {"home": [0]},
            "cannot hold itself up at home: j needs 4.9.* of 2 Nm.*torque_limit=",
        ),
        (_changed("", ""), {"others": "free"}, "others is 'free', but must be"),
        (_changed("</mujoco>", ""), {}, "the MJCF text cannot be read"),
        (_changed('joint="j"', 'joint="k"'), {}, "does not compile: .*unknown"),
        ("nowhere.xml", {}, "no file nowhere.xml"),
        ("robot.urdf", {}, "is a URDF: read it by from_urdf"),
    ],
)
def test_what_cannot_be_taken_in_is_one_line(text, arguments, message):
    with pytest.raises(ArgumentError, match=message) as caught:
        take_in(text, **{"hands": {"h": "s"}, **arguments})
    assert "\n" not in str(caught.value)


def test_arm_joints_tied_to_each_other_are_refused(planar_arm):
    tied = planar_arm.replace(
        "</worldbody>",
        '</worldbody><equality><joint joint1="joint2" joint2="joint1"/></equality>',
    )
    with pytest.raises(ArgumentError, match="'joint2' follows arm joint 'joint1'"):
        take_in(tied, hands={"hand": "tip"}, torque_limit=5)


def test_a_tendon_between_arm_and_finger_cannot_be_cut(servo_arm):
    coupled = servo_arm.replace('<joint joint="right" coef="1"/>', '<joint joint="roll" coef="1"/>')
    with pytest.raises(ArgumentError, match=r"tendon 'grip' couples left.*with roll"):
        take_in(coupled, hands={"hand": "tool"})
