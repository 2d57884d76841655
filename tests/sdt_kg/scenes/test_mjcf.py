"""MJCF says what collides in more than one way."""

from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.scenes import read_scene

PAIR = """<mujoco><default><geom contype="0" conaffinity="0"/></default><worldbody>
<geom name="wall" type="box" size="1 1 1"/><geom name="picture" type="box" size="2 2 2"/>
<body name="ball"><geom name="ball" type="sphere" size="0.1"/></body></worldbody>
<contact><pair geom1="ball" geom2="wall"/></contact></mujoco>"""


def test_geoms_of_a_contact_pair_collide_whatever_their_bits(tmp_path: Path) -> None:
    (tmp_path / "s.xml").write_text(PAIR, encoding="utf-8")
    mechanism = read_scene(tmp_path / "s.xml")
    sizes = {body.name: [shape.size for shape in body.collision] for body in mechanism.bodies}
    assert sizes == {"world": [(2.0, 2.0, 2.0)], "ball": [(0.1,)]}
    assert "not carried over: geoms that collide with nothing: picture" in mechanism.notes


def test_an_ellipsoid_that_something_may_collide_with_is_refused(tmp_path: Path) -> None:
    # Nothing would be met there, and a motion through it certified.
    egg = '<mujoco><worldbody><geom name="egg" type="ellipsoid" size=".3 .9 .9"/></worldbody></mujoco>'
    (tmp_path / "s.xml").write_text(egg, encoding="utf-8")
    with pytest.raises(UrdfError, match=r"geom 'egg' is an ellipsoid; allowed: box, .*; write it as"):
        read_scene(tmp_path / "s.xml")


HINGE = """<mujoco>{}<worldbody><body name="door"><joint name="hinge" axis="0 0 1" range="0 {}"/>
<geom type="box" size=".1 .1 .1"/></body></worldbody></mujoco>"""
RADIANS = '<compiler angle="radian" autolimits="true"/>'


@pytest.mark.parametrize(
    ("compiler", "upper", "told"), [("", 1.57, True), ("", 90, False), (RADIANS, 1.57, False)]
)
def test_a_range_that_may_be_in_radians_is_told(
    tmp_path: Path, compiler: str, upper: float, told: bool
) -> None:
    # Read in degrees, the door would be open after 1.4 of them.
    (tmp_path / "s.xml").write_text(HINGE.format(compiler, upper), encoding="utf-8")
    notes = read_scene(tmp_path / "s.xml").notes
    said = "hinges turn by 0.0274 rad at most: ranges are read in degrees"
    assert any(note.startswith(said) and note.endswith("may be in radians") for note in notes) is told
