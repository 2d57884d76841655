"""Xacro → Mechanism: expanded, and refused where it is wrong or reads what is not its own."""

from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.urdf import model_stem, read_mechanism
from tests.sdt_kg.conftest import DRAWER

HEAD = '<robot name="k" xmlns:xacro="http://www.ros.org/wiki/xacro">'


def test_xacro_is_expanded(tmp_path: Path) -> None:
    path = tmp_path / "my.urdf.xacro"
    body = (
        f'<xacro:property name="n" value="0.5"/>{"".join(DRAWER).replace("0.4 0.5 0.2", "0.4 ${n} ${n/2}")}'
    )
    path.write_text(f"{HEAD}{body}</robot>", encoding="utf-8")
    model = read_mechanism(path)
    assert model.name == "my" == model_stem(path)
    assert model.bodies[1].collision[0].size == (0.4, 0.5, 0.25)


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('<link name="${nope}"/>', "name 'nope' is not defined"),
        ('<xacro:include filename="nowhere.xacro"/>', "No such file"),
        ('<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>', "without end"),
        ('<link name="${__import__(1)}"/>', "invalid name"),
        ('<xacro:include filename="broken.xml"/>', "syntax error"),
        ("<xacro:unless/>", "missing attribute 'value'"),
        ('<link name="l"/><xacro:include filename="../outside.xml"/>', "outside.xml', which lies outside of"),
        ("<link name=\"${xacro.load_yaml('../outside.xml')}\"/>", "outside.xml', which lies outside of"),
    ],
)
def test_a_bad_xacro_is_refused_with_its_reason(tmp_path: Path, body: str, reason: str) -> None:
    (tmp_path / "in").mkdir()
    path = tmp_path / "in" / "my.xacro"
    (tmp_path / "outside.xml").write_text("<robot/>")
    (tmp_path / "in" / "broken.xml").write_text("no XML")
    path.write_text(f"{HEAD}{body}</robot>", encoding="utf-8")
    with pytest.raises(UrdfError) as caught:
        read_mechanism(path)
    assert reason in str(caught.value)


def test_xacro_reads_what_is_in_its_package(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    path = tmp_path / "in" / "my.xacro"
    (tmp_path / "more.xacro").write_text(f"{HEAD}{''.join(DRAWER)}</robot>")
    path.write_text(f'{HEAD}<xacro:include filename="../more.xacro"/></robot>')
    with pytest.raises(UrdfError, match="outside of"):
        read_mechanism(path)
    (tmp_path / "package.xml").write_text("<package/>")
    assert len(read_mechanism(path).bodies) == len([each for each in DRAWER if "<link" in each])
