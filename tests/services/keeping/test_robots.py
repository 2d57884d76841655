"""A robot that was kept on disk is the robot that its files say, or is read anew."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import robots
from sdt_kg import load
from sdt_kg.entities import Entities
from sdt_kg.errors import AnnotationError, UrdfError
from services.keeping import robots as keeping
from services.keeping.files import folder
from services.keeping.robots import ROBOTS, read_robot

ALL = ("pr2", "tiago_dual", "stretch")


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Robots whose files were read."""
    names: list[str] = []
    usual = load.read_robot

    def told(robot: str | Path) -> Entities:
        names.append(str(robot))
        return usual(robot)

    monkeypatch.setattr(load, "read_robot", told)
    return names


BALL = '<link name="ball"><collision><geometry><mesh filename="{}"/></geometry></collision></link>'
JOINT = '<joint name="neck" type="fixed"><parent link="base_link"/><child link="ball"/></joint></robot>'


@pytest.fixture
def own(tmp_path: Path) -> Path:
    """A robot with a mesh and an annotation of its own."""
    (tmp_path / "meshes").mkdir()
    for name in ("one.obj", "other.obj"):
        (tmp_path / "meshes" / name).write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    (tmp_path / "link.obj").symlink_to(tmp_path / "meshes" / "one.obj")
    text = (robots.path("stretch") / "stretch.urdf").read_text(encoding="utf-8")
    urdf = tmp_path / "stretch.urdf"
    urdf.write_text(text.replace("</robot>", BALL.format("link.obj") + JOINT), encoding="utf-8")
    shutil.copy(robots.path("stretch") / "stretch.ttl", tmp_path)
    return urdf


def everything(robot: Entities) -> tuple[object, ...]:
    """All that is asked of a robot that is put beside a kitchen."""
    model = robot.environment
    quads = frozenset(map(str, robot.store.dump(robot.graphs)))
    read_back = robot.mechanism(model), robot.content_hash(model), robot.containers, robot.notes
    return (model, robot.graphs, quads, *read_back, list(robot._facts_of(model).triples()))


@pytest.mark.parametrize("name", ALL)
def test_what_was_kept_says_what_is_read_in_the_same_order(name: str, read: list[str]) -> None:
    first, kept, usual = read_robot(name), read_robot(name), load.read_robot(name)
    assert read == [name, name], "the second was kept"
    assert everything(first) == everything(kept) == everything(usual)
    kept._hashes.clear()
    assert kept.content_hash(kept.environment) == usual.content_hash(usual.environment)


def test_in_a_kitchen_it_is_the_same_robot() -> None:
    read_robot("pr2")
    kitchen = load.load_twin("b")
    one, other = load.with_robot(kitchen, read_robot("pr2")), load.load_twin("b", ["pr2"])
    robot = other.robots[0]
    assert one.robot(robot) == other.robot(robot)
    assert (one.robots, one.notes, one.state) == (other.robots, other.notes, other.state)
    assert one.content_hash(robot) == other.content_hash(robot)


def _mesh(urdf: Path) -> None:
    (urdf.parent / "meshes" / "one.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 2 3\nf 1 2 4\n")


def _link(urdf: Path) -> None:
    (urdf.parent / "link.obj").unlink()
    (urdf.parent / "link.obj").symlink_to(urdf.parent / "meshes" / "other.obj")


def _text(urdf: Path) -> None:
    urdf.write_text(urdf.read_text(encoding="utf-8").replace('name="neck"', 'name="nape"'), encoding="utf-8")


def _annotation(urdf: Path) -> None:
    file = urdf.with_suffix(".ttl")
    file.write_text(file.read_text(encoding="utf-8") + "\n# later\n", encoding="utf-8")


@pytest.mark.parametrize("change", [_mesh, _link, _text, _annotation])
def test_a_file_that_changed_is_read(own: Path, read: list[str], change: Callable[[Path], None]) -> None:
    read_robot(own)
    read_robot(own)
    assert len(read) == 1
    change(own)
    assert everything(read_robot(own)) == everything(load.read_robot(own))
    assert len(read) == 3
    read_robot(own)
    assert len(read) == 3, "kept again"


def test_an_annotation_that_is_taken_away_is_missed(own: Path) -> None:
    text = own.read_text(encoding="utf-8")
    own.write_text(text.replace("base_link", "chassis"), encoding="utf-8")
    file = own.with_suffix(".ttl")
    file.write_text(file.read_text(encoding="utf-8").replace("base_link", "chassis"), encoding="utf-8")
    read_robot(own)
    file.unlink()
    with pytest.raises(AnnotationError):
        read_robot(own)


def test_a_mesh_that_is_gone_is_missed(own: Path) -> None:
    read_robot(own)
    (own.parent / "meshes" / "one.obj").unlink()
    with pytest.raises(UrdfError, match="no mesh file"):
        read_robot(own)


def test_other_code_reads_anew(own: Path, read: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    read_robot(own)
    monkeypatch.setattr(keeping, "_code", lambda: "another version")
    read_robot(own)
    assert len(read) == 2


@pytest.mark.parametrize("byte", [0, 33, 1000, -1])
def test_a_damaged_file_is_read_anew_and_replaced(own: Path, read: list[str], byte: int) -> None:
    usual = everything(read_robot(own))
    (file,) = folder(ROBOTS).iterdir()
    content = bytearray(file.read_bytes())
    content[byte] ^= 1
    file.write_bytes(content)
    assert everything(read_robot(own)) == usual
    assert everything(read_robot(own)) == usual
    assert len(read) == 2


def test_processes_that_read_it_at_once_leave_one_whole_file(own: Path, read: list[str]) -> None:
    for _ in range(4):
        if os.fork() == 0:
            read_robot(own)
            os._exit(0)
    assert [os.waitpid(-1, 0)[1] for _ in range(4)] == [0] * 4
    assert len(list(folder(ROBOTS).iterdir())) == 1
    read_robot(own)
    assert read == []


def test_where_nothing_can_be_kept_it_is_read_each_time(
    own: Path, read: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert everything(read_robot(own)) == everything(read_robot(own))
    assert len(read) == 2
