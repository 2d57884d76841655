"""MJCF says what collides in more than one way."""

from pathlib import Path

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
