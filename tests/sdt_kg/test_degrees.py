"""Angles of a URDF are radians; what would be plausible in degrees alone is told with every verdict."""

import pytest

from sdt_kg.load import load_twin
from sdt_kg.urdf import read_mechanism
from tests.sdt_kg.conftest import Write, joint, limit, link

TOLD = "angles are read in radians, and these may be in degrees: "
SHAPE = (
    '<link name="{}"><collision><origin rpy="{}"/><geometry><box size="1 1 1"/></geometry></collision></link>'
)


def hinge(inside: str, kind: str = "revolute") -> tuple[str, ...]:
    return link("world"), link("arm"), joint("hinge", kind, "world", "arm", inside)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        (hinge(f'<origin rpy="0 0  90"/>{limit(0, 1)}'), "rpy of joint 'hinge' (0 0 90)"),
        ((SHAPE.format("a", "-180 0 0"),), "rpy of link 'a' (-180 0 0)"),
        (hinge(limit(-180, 180)), "limits of joint 'hinge' (-180 to 180)"),
        (hinge(limit(0, 1, 180)), "velocity of joint 'hinge' (180 a second)"),
        (
            hinge(f'<origin rpy="45 0 0"/>{limit(-90, 0, 120)}'),
            "rpy of joint 'hinge' (45 0 0); limits of joint 'hinge' (-90 to 0); "
            "velocity of joint 'hinge' (120 a second)",
        ),
    ],
)
def test_angles_that_may_be_in_degrees_are_told(write: Write, parts: tuple[str, ...], said: str) -> None:
    assert read_mechanism(write(*parts)).notes == (TOLD + said,)


@pytest.mark.parametrize(
    "parts",
    [
        hinge(f'<origin rpy="-6.2832 6.2832 3.14"/>{limit(-6.3, 6.3, 25)}'),
        hinge(limit(-1e16, 1e16, 1e6)),  # stands for none
        hinge('<limit velocity="100" effort="1"/>', "continuous"),  # a wheel
        hinge(limit(0, 180, 90), "prismatic"),  # a length
        ('<link name="a"><visual><origin rpy="0 0 90"/><geometry/></visual></link>',),
    ],
)
def test_what_radians_may_well_be_is_not(write: Write, parts: tuple[str, ...]) -> None:
    assert not [note for note in read_mechanism(write(*parts)).notes if TOLD in note]


@pytest.mark.parametrize("model", ["a", "b"])
def test_no_bundled_model_is_said_to_be_in_degrees(model: str) -> None:
    twin = load_twin(model, ["pr2", "tiago_dual", "stretch"])
    assert not [note for note in twin.notes if TOLD in note]
