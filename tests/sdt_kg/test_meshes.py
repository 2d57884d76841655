"""A collision shape is all in the file whose hash is in every verdict."""

from pathlib import Path

import pytest

from sdt_kg.errors import UrdfError
from sdt_kg.urdf.read import read_mechanism


def urdf(folder: Path, mesh: str) -> Path:
    (folder / mesh).touch()
    path = folder / "k.urdf"
    shape = f'<collision><geometry><mesh filename="{mesh}"/></geometry></collision>'
    path.write_text(f'<robot name="k"><link name="world">{shape}</link></robot>', encoding="utf-8")
    return path


@pytest.mark.parametrize("mesh", ["a.gltf", "a.glb", "a.lws", "a"])
def test_a_mesh_whose_shape_may_lie_in_other_files_is_refused(tmp_path: Path, mesh: str) -> None:
    with pytest.raises(UrdfError, match=f"the shape of mesh '{mesh}' may lie in other files too"):
        read_mechanism(urdf(tmp_path, mesh))


@pytest.mark.parametrize("mesh", ["a.stl", "a.OBJ", "a.dae", "a.ply", "a.off"])
def test_a_mesh_that_is_one_file_is_read(tmp_path: Path, mesh: str) -> None:
    assert read_mechanism(urdf(tmp_path, mesh)).bodies[0].collision[0].mesh_file == str(tmp_path / mesh)
