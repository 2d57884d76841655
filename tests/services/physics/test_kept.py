"""Pieces of meshes that are kept on disk are those that were made, or are made anew."""

import os
from collections.abc import Callable
from pathlib import Path

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
import trimesh

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.urdf.meshes import mesh_hash
from services.keeping.files import folder
from services.physics.geometry.depth import faces
from services.physics.geometry.fans import fanned
from services.physics.geometry.hulls import FINE
from services.physics.geometry.kept import PIECES as KIND
from services.physics.geometry.kept import Array, kept
from services.physics.geometry.packed import _fanned
from services.physics.geometry.shapes import hull_of_solid, solids, surface

PIECES = [
    np.array([[0.0, 0.0, 0.1], [1.0, 0.0, -0.0], [0.0, 1.0, 0.3]]),
    np.array([[7, -1]]),
    np.empty((0, 1), np.int64),
    np.array([[0.1, 0.2, 0.7]]),
]


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def made() -> tuple[list[int], Callable[[], list[Array]]]:
    """How often pieces were made, and what makes them."""
    count: list[int] = []

    def make() -> list[Array]:
        count.append(1)
        return PIECES

    return count, make


def mesh_at(path: Path) -> Geometry:
    """The mesh of a file, as a model names it."""
    return Geometry(ShapeType.MESH, Pose(), (1.0, 1.0, 1.0), str(path), mesh_hash(path))


def same(one: list[Array], other: list[Array]) -> bool:
    pairs = zip(one, other, strict=True)
    return all(a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes() for a, b in pairs)


def test_what_was_made_once_is_read_to_the_last_digit(made) -> None:
    count, make = made
    assert same(kept(("mesh", 1.0), make), PIECES)
    assert same(kept(("mesh", 1.0), make), PIECES)
    assert len(count) == 1


def test_anything_that_decides_them_is_part_of_the_key(made) -> None:
    count, make = made
    for key in (("mesh", 1.0), ("mesh", 2.0), ("other", 1.0)):
        kept(key, make)
    assert len(count) == 3


@pytest.mark.parametrize("byte", [0, 40, 200, -1])
def test_a_file_that_was_changed_in_one_bit_is_made_anew(made, byte: int) -> None:
    count, make = made
    kept(("mesh",), make)
    (file,) = folder(KIND).iterdir()
    content = bytearray(file.read_bytes())
    content[byte] ^= 1
    file.write_bytes(content)
    assert same(kept(("mesh",), make), PIECES)
    assert len(count) == 2
    assert same(kept(("mesh",), make), PIECES)
    assert len(count) == 2


@pytest.mark.parametrize("length", [0, 10, 32, 100])
def test_a_file_that_is_cut_off_is_made_anew(made, length: int) -> None:
    count, make = made
    kept(("mesh",), make)
    (file,) = folder(KIND).iterdir()
    file.write_bytes(file.read_bytes()[:length])
    assert same(kept(("mesh",), make), PIECES)
    assert len(count) == 2


@pytest.mark.skipif(os.geteuid() != 0, reason="only root gives files to others")
def test_what_another_user_wrote_is_made_anew(made) -> None:
    count, make = made
    kept(("mesh",), make)
    (file,) = folder(KIND).iterdir()
    os.chown(file, 12345, -1)
    assert same(kept(("mesh",), make), PIECES)
    assert len(count) == 2


def test_two_processes_that_make_the_same_leave_one_whole_file(made) -> None:
    _, make = made
    for _ in range(4):
        if os.fork() == 0:
            kept(("mesh",), make)
            os._exit(0)
    assert [os.waitpid(-1, 0)[1] for _ in range(4)] == [0] * 4
    (file,) = folder(KIND).iterdir()
    assert same(kept(("mesh",), lambda: []), PIECES), file


def test_where_nothing_can_be_kept_pieces_are_made_each_time(
    made, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    count, make = made
    assert same(kept(("mesh",), make), PIECES)
    assert same(kept(("mesh",), make), PIECES)
    assert len(count) == 2


def test_a_mesh_has_the_same_hulls_whether_they_were_kept_or_not(tmp_path: Path) -> None:
    bent = trimesh.util.concatenate(
        [trimesh.creation.box((1, 0.1, 0.1)), trimesh.creation.box((0.1, 0.1, 1))]
    )
    for name in ("one.stl", "same.stl"):
        bent.export(tmp_path / name)
    first, second = (solids(mesh_at(tmp_path / name), FINE) for name in ("one.stl", "same.stl"))
    assert len(list(folder(KIND).iterdir())) == 1
    assert len(first) > 1
    assert [np.array(each.points()).tolist() for each in first] == [
        np.array(each.points()).tolist() for each in second
    ]
    for each in first:
        corners = np.array(each.points())
        assert np.abs(corners).max() <= 0.5 + 1e-12


def test_a_kept_hull_is_what_qhull_makes_of_its_points(tmp_path: Path) -> None:
    trimesh.creation.icosphere(subdivisions=1).export(tmp_path / "ball.stl")
    geometry = mesh_at(tmp_path / "ball.stl")
    box, away, there = coal.Box(0.2, 0.3, 0.4), coal.Transform3s(), coal.Transform3s()
    away.setTranslation(np.array([1.4, 0.3, 0.2]))
    for one in solids(geometry):
        points = np.array(one.points())
        other = hull_of_solid(points)  # the same points in another order
        assert sorted(points.tolist()) == sorted(np.array(other.points()).tolist())
        assert one.num_polygons == other.num_polygons
        assert _edges(one) == _edges(other)
        middle = (one.aabb_local.min_ + one.aabb_local.max_) / 2
        assert all(map(np.array_equal, _fanned(one), fanned(points - middle)))
        found = [
            coal.distance(each, there, box, away, coal.DistanceRequest(), coal.DistanceResult())
            for each in (one, other)
        ]
        assert found[0] == pytest.approx(found[1], abs=1e-12)
        assert sorted(faces(one).offsets) == pytest.approx(sorted(faces(other).offsets))


def _edges(hull: coal.Convex) -> set[frozenset[tuple[float, ...]]]:
    points = list(map(tuple, np.array(hull.points()).tolist()))
    return {frozenset((points[i], points[k])) for i in range(len(points)) for k in hull.neighbors(i)}


@pytest.mark.parametrize("shapes", [solids, surface])
def test_a_file_that_changed_since_its_model_was_read_is_refused_and_nothing_is_kept_of_it(
    tmp_path: Path, shapes: Callable[[Geometry], object]
) -> None:
    file = tmp_path / "one.stl"
    trimesh.creation.box((1, 1, 1)).export(file)
    read = mesh_at(file)
    trimesh.creation.box((3, 3, 3)).export(file)
    os.utime(file, ns=(1, 1))
    with pytest.raises(UrdfError, match="another file than when its model was read"):
        shapes(read)
    assert not folder(KIND).exists()
    shapes(mesh_at(file))
