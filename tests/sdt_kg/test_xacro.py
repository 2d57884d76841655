"""Xacro → Mechanism: expanded, and refused where it is wrong or reads what is not its own."""

from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.urdf import model_stem, read_mechanism, xacro
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
        ('<link name="${(lambda: ().__class__)()}"/>', "invalid name: __class__"),
        ('<link name="${[a.__class__ for a in (1,)]}"/>', "invalid name: __class__"),
        ('<link name="${python.vars(xacro.load_yaml)}"/>', "invalid name: vars"),
        ("<xacro:property name='f' value='{0.real}'/><link name='${f.format(1)}'/>", "invalid name: format"),
        ('<link name="$(env HOME)"/>', "HOME"),
        ('<xacro:include filename="$(find other)/more.xacro"/>', "package 'other' is not the one"),
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


def test_xacro_finds_its_own_package_by_name(tmp_path: Path) -> None:
    (tmp_path / "urdf").mkdir()
    path = tmp_path / "urdf" / "my.xacro"
    (tmp_path / "package.xml").write_text("<package><name>mine</name></package>")
    (tmp_path / "more.xacro").write_text(f"{HEAD}{''.join(DRAWER)}</robot>")
    for name in ("mine", tmp_path.name):
        path.write_text(f'{HEAD}<xacro:include filename="$(find {name})/more.xacro"/></robot>')
        assert len(read_mechanism(path).bodies) == len([each for each in DRAWER if "<link" in each])


def doubled(times: int) -> str:
    """Macros of which each calls the next one twice."""
    calls = (
        f'<xacro:macro name="m{k}"><xacro:m{k + 1}/><xacro:m{k + 1}/></xacro:macro>' for k in range(times)
    )
    return f'{"".join(calls)}<xacro:macro name="m{times}"><link name="l"/></xacro:macro><xacro:m0/>'


ENDLESS = {
    "power": '<link name="${9**9**9}"/>',
    "loop": '<link name="${python.sum(python.range(10**12))}"/>',
    "memory": """<link name="${len('a' * 10**10)}"/>""",
    "macros": doubled(40),
}


@pytest.mark.parametrize("body", ENDLESS.values(), ids=ENDLESS)
def test_a_xacro_that_grows_without_end_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, body: str
) -> None:
    monkeypatch.setattr(xacro, "SECONDS", 1)
    path = tmp_path / "my.xacro"
    path.write_text(f"{HEAD}{body}</robot>", encoding="utf-8")
    with pytest.raises(UrdfError, match=r"takes too much|too much memory|bytes; allowed"):
        read_mechanism(path)


def test_what_a_xacro_prints_is_not_its_document(tmp_path: Path) -> None:
    path = tmp_path / "my.xacro"
    path.write_text(f"{HEAD}${{xacro.message('no document')}}{''.join(DRAWER)}</robot>")
    assert read_mechanism(path).name == "my"


def test_a_path_with_umlauts_is_read_whatever_the_locale(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LC_ALL", "C")
    path = tmp_path / "Küche mit Türen" / "große.xacro"
    path.parent.mkdir()
    path.write_text(f"{HEAD}<!-- Tür -->{''.join(DRAWER)}</robot>", encoding="utf-8")
    assert read_mechanism(path).name == "große"


def test_a_xacro_that_wants_an_argument_says_how_to_give_it(tmp_path: Path) -> None:
    path = tmp_path / "my.xacro"
    path.write_text(f'{HEAD}<xacro:arg name="side"/>{"".join(DRAWER)}</robot>', encoding="utf-8")
    with pytest.raises(UrdfError, match=r"with its arguments: xacro FILE NAME:=VALUE > FILE.urdf"):
        read_mechanism(path)
