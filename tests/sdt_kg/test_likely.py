"""Which bundled robots joints seem to be of."""

import pytest

from sdt_kg.likely import likely, told_likely

PR2 = ("torso_lift_joint", "l_shoulder_pan_joint", "l_elbow_flex_joint", "r_wrist_roll_joint")


@pytest.mark.parametrize(
    ("joints", "robots", "count"),
    [
        (PR2, ("pr2",), 4),
        ((*PR2, "knee_joint"), ("pr2",), 4),
        (("torso_lift_joint",), ("pr2", "tiago_dual"), 1),
        (("joint_lift", "joint_wrist_yaw"), ("stretch",), 2),
        (("joint_lift", "panda_joint1"), (), 0),
        (("panda_joint1", "panda_joint2"), (), 0),
        ((), (), 0),
    ],
)
def test_joints_are_those_of_the_robots_that_have_most_of_them(
    joints: tuple[str, ...], robots: tuple[str, ...], count: int
) -> None:
    assert likely(joints) == (robots, count)


def test_whose_they_are_is_told_unless_it_is_who_is_asked_about() -> None:
    assert told_likely(PR2) == "pr2 has all of the motion's 4 joints"
    assert told_likely((*PR2, "knee_joint")) == "pr2 has 4 of the motion's 5 joints"
    assert told_likely(("torso_lift_joint",)) == "pr2 and tiago_dual have the motion's joint"
    assert told_likely(("torso_lift_joint",), ("pr2",)) == told_likely(("panda_joint1",)) == ""
