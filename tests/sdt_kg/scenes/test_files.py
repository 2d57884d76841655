"""Files of a scene or model: those of its folder or package, or of the folder that SDT_MODELS names."""

from pathlib import Path

import pytest
import trimesh

from sdt_kg.errors import UrdfError
from sdt_kg.scenes import read_scene
from sdt_kg.urdf import read_mechanism

SCENE = """<mujoco><compiler meshdir="../meshes" texturedir="../textures"/>
<include file="../parts/door.xml"/>
<asset><mesh name="m" file="../meshes/m.stl"/></asset>
<worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"""
DOOR = '<mujoco><worldbody><body name="door"><geom type="box" size="1 1 1"/></body></worldbody></mujoco>'
URDF = """<robot name="k"><link name="w"><collision><geometry><mesh filename="{}"/></geometry></collision>
</link></robot>"""


@pytest.fixture
def models(tmp_path: Path) -> Path:
    """Scenes, parts and meshes in folders beside each other."""
    for name in ("scenes", "parts", "meshes"):
        (tmp_path / "models" / name).mkdir(parents=True)
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "models" / "meshes" / "m.stl")
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "secret.stl")
    (tmp_path / "models" / "parts" / "door.xml").write_text(DOOR, encoding="utf-8")
    (tmp_path / "models" / "scenes" / "s.xml").write_text(SCENE, encoding="utf-8")
    return tmp_path / "models"


def test_a_scene_whose_files_lie_beside_its_folder_says_what_to_do(models: Path) -> None:
    with pytest.raises(UrdfError, match=r"lies outside of '.*scenes'.*set SDT_MODELS to the folder"):
        read_scene(models / "scenes" / "s.xml")


@pytest.mark.parametrize("way", ["SDT_MODELS", "package.xml"])
@pytest.mark.parametrize("relative", [True, False])
def test_files_of_the_folder_that_is_named_or_of_the_package_are_read(
    models: Path, monkeypatch: pytest.MonkeyPatch, way: str, relative: bool
) -> None:
    if way == "SDT_MODELS":
        monkeypatch.setenv(way, str(models))
    else:
        (models / way).write_text("<package/>", encoding="utf-8")
    monkeypatch.chdir(models)
    scene = read_scene(Path("scenes/s.xml") if relative else models / "scenes" / "s.xml")
    assert [body.name for body in scene.bodies] == ["world", "door"]
    assert scene.bodies[0].collision[0].mesh_file == str(models / "meshes" / "m.stl")
    urdf = models / "scenes" / "k.urdf"
    urdf.write_text(URDF.format("../meshes/m.stl"), encoding="utf-8")
    assert read_mechanism(urdf).bodies[0].collision[0].mesh_file == str(models / "meshes" / "m.stl")


@pytest.mark.parametrize(
    "reference",
    ["../secret.stl", "../../secret.stl", "package://../secret.stl", "package://./../secret.stl",
     "package:///../secret.stl", "package://meshes/../../secret.stl", "package://scenes/../../secret.stl"],
)  # fmt: skip
@pytest.mark.parametrize("named", [True, False])
def test_a_file_beyond_is_refused(
    models: Path, monkeypatch: pytest.MonkeyPatch, reference: str, named: bool
) -> None:
    if named:
        monkeypatch.setenv("SDT_MODELS", str(models))
    (models.parent / "secret.stl").replace(
        models / "secret.stl" if not named else models.parent / "secret.stl"
    )
    urdf = models / "scenes" / "k.urdf"
    urdf.write_text(URDF.format(reference), encoding="utf-8")
    with pytest.raises(UrdfError, match=r"lies outside of|no mesh file"):
        read_mechanism(urdf)


def test_a_folder_that_the_model_is_not_in_changes_nothing(
    models: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SDT_MODELS", str(tmp_path / "others"))
    with pytest.raises(UrdfError, match="lies outside of"):
        read_scene(models / "scenes" / "s.xml")


def test_a_package_in_the_folder_that_is_named_is_found(
    models: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    urdf = models / "scenes" / "k.urdf"
    for reference in ("package://meshes/m.stl", "package:///meshes/m.stl"):
        urdf.write_text(URDF.format(reference), encoding="utf-8")
        monkeypatch.delenv("SDT_MODELS", raising=False)
        with pytest.raises(UrdfError, match="no mesh file"):
            read_mechanism(urdf)
        monkeypatch.setenv("SDT_MODELS", str(models))
        assert read_mechanism(urdf).bodies[0].collision[0].mesh_file == str(models / "meshes" / "m.stl")


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ('<mujoco><compiler assetdir="../.."/></mujoco>', r"assetdir='../..' lies outside of"),
        ('<mujoco><asset><texture file="../../a.png" type="2d"/></asset></mujoco>', "a.png' lies outside of"),
        ('<mujoco><asset><model name="n" file="../parts/inner.xml"/></asset></mujoco>', "etc' lies outside"),
    ],
)
def test_what_is_included_or_attached_reads_nothing_beyond_either(
    models: Path, monkeypatch: pytest.MonkeyPatch, part: str, message: str
) -> None:
    monkeypatch.setenv("SDT_MODELS", str(models))
    (models / "parts" / "door.xml").write_text(part, encoding="utf-8")
    (models / "parts" / "inner.xml").write_text(
        '<mujoco><compiler meshdir="/etc"/></mujoco>', encoding="utf-8"
    )
    with pytest.raises(UrdfError, match=message):
        read_scene(models / "scenes" / "s.xml")


def test_a_part_of_a_scene_is_no_scene(tmp_path: Path) -> None:
    (tmp_path / "p.xml").write_text("<mujocoinclude/>", encoding="utf-8")
    with pytest.raises(UrdfError, match="give the file that includes it"):
        read_scene(tmp_path / "p.xml")
