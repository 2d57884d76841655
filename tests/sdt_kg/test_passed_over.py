"""What readers of URDF pass over, and a verdict would not know of, is refused."""

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.conftest import Write, joint, limit, link

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
XI = 'xmlns:xi="http://www.w3.org/2001/XInclude"'
BOX = '<geometry><box size="1 1 1"/></geometry>'
INERTIAL = '<inertial><mass value="1"/></inertial>'
SLIDE = (link("world"), link("drawer"))

BAD: dict[str, tuple[tuple[str, ...], str]] = {
    "xacro in a .urdf": ((link("a"), f'<xacro:wall {XACRO} at="1"/>'), "has <xacro:wall>"),
    "xacro in a link": ((f'<link name="a"><xacro:shape {XACRO}/></link>',), "name the file .xacro"),
    "xacro's own include": ((link("a"), f'<xacro:include {XACRO} filename="b"/>'), "has <xacro:include>"),
    "another file": ((link("a"), '<include filename="b.urdf"/>'), "put in what it includes"),
    "another file by XInclude": ((link("a"), f'<xi:include {XI} href="b"/>'), "has <include>"),
    "two geometries": (
        (f'<link name="a"><collision>{BOX}{BOX}</collision></link>',),
        "collision has <geometry> more than once; allowed: one",
    ),
    "two inertias": ((f'<link name="a">{INERTIAL * 2}</link>',), "link 'a' has <inertial> more than once"),
    "two axes": (
        (*SLIDE, joint("slide", "prismatic", "world", "drawer", limit(0, 1) + 2 * '<axis xyz="0 0 1"/>')),
        "joint 'slide' has <axis> more than once",
    ),
    "two parents in a joint": (
        (*SLIDE, joint("slide", "fixed", "world", "drawer", '<parent link="drawer"/>')),
        "joint 'slide' has <parent> more than once",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_would_be_passed_over_is_refused(write: Write, case: str) -> None:
    parts, reason = BAD[case]
    with pytest.raises(UrdfError, match=reason):
        read_mechanism(write(*parts))


def test_a_link_may_have_several_shapes_and_what_no_verdict_looks_at_twice(write: Write) -> None:
    dynamics = '<dynamics damping="1"/>'
    slide = joint("slide", "prismatic", "world", "drawer", limit(0, 1) + 2 * dynamics)
    model = read_mechanism(write(link("world", *2 * ['<box size="1 1 1"/>']), link("drawer"), slide))
    assert len(model.bodies[0].collision) == 2


def test_of_two_limits_the_first_holds_and_is_told(write: Write) -> None:
    """As in the reference's kitchen b, whose oven drawer has 0.48 m, and then 0."""
    slide = joint("slide", "prismatic", "world", "drawer", limit(0.0, 0.48) + limit(0, 0))
    model = read_mechanism(write(*SLIDE, slide))
    assert model.joint("slide").limits.upper == 0.48
    assert model.notes == ("joint 'slide' has <limit> more than once: the first is taken",)
