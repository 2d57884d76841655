"""Whether a box lies in several shapes together: not where a point of it lies in none."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from sdt_kg.mechanism import Geometry, Pose, ShapeType
from sdt_kg.urdf.meshes import mesh_hash
from services.embodiment.proof_check.inside.covered import STICKS_OUT, is_covered, sticks_out
from services.physics.geometry.hulls import COARSE, FINE
from services.physics.geometry.shapes import solids

WHOLE = (0.2, 0.3, 0.5)
ROUND = Geometry(ShapeType.CYLINDER, Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)), (0.2, 0.4))
Array = np.ndarray


def at(*position: float, turned: Rotation | None = None) -> Pose:
    x, y, z = position
    return Pose((x, y, z), tuple((turned or Rotation.identity()).as_quat().tolist()))


def box(size: tuple[float, ...], pose: Pose) -> Geometry:
    return Geometry(ShapeType.BOX, pose, size)


def blocks(cuts: list[Array], gap: float = 0.0) -> list[Geometry]:
    """What is left of the whole box, cut along each axis at these places, with gaps of a width there."""
    spans = []
    for size, cut in zip(WHOLE, cuts, strict=True):
        edges = np.concatenate(([-size / 2], np.sort(cut), [size / 2]))
        spans.append([(a + gap / 2, b - gap / 2) for a, b in pairwise(edges)])
    return [
        box((x[1] - x[0], y[1] - y[0], z[1] - z[0]), at(sum(x) / 2, sum(y) / 2, sum(z) / 2))
        for x in spans[0]
        for y in spans[1]
        for z in spans[2]
    ]


def turned_with(one: Geometry, by: Pose) -> Geometry:
    matrix = by.matrix() @ one.pose.matrix()
    turn = Rotation.from_matrix(matrix[:3, :3])
    return replace(one, pose=at(*matrix[:3, 3].tolist(), turned=turn))


def inside(one: Geometry, points: Array) -> Array:
    """Which points (N, 3) lie in a box, a sphere or a cylinder that is larger by what may stick out."""
    matrix = one.pose.matrix()
    seen = (points - matrix[:3, 3]) @ matrix[:3, :3]
    if one.shape is ShapeType.BOX:
        return (np.abs(seen) <= np.array(one.size) / 2 + STICKS_OUT).all(axis=1)
    if one.shape is ShapeType.SPHERE:
        return np.linalg.norm(seen, axis=1) <= one.size[0] + STICKS_OUT
    across = np.linalg.norm(seen[:, :2], axis=1) <= one.size[0] + STICKS_OUT
    return across & (np.abs(seen[:, 2]) <= one.size[1] / 2 + STICKS_OUT)


def samples(one: Geometry, rng: np.random.Generator, count: int) -> Array:
    matrix = one.pose.matrix()
    return rng.uniform(-0.5, 0.5, (count, 3)) * np.array(one.size) @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("seed", range(12))
def test_a_box_lies_in_what_it_was_cut_into_and_in_no_fewer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = at(*rng.uniform(-1, 1, 3).tolist(), turned=Rotation.random(random_state=seed))
    cuts = [rng.uniform(-size / 2, size / 2, rng.integers(0, 3)) for size in WHOLE]
    parts = [turned_with(one, pose) for one in blocks(cuts)]
    rng.shuffle(parts)  # pyright: ignore[reportArgumentType]
    whole = box(WHOLE, pose)
    assert is_covered(whole, tuple(parts))
    if len(parts) > 1:
        for k in range(len(parts)):
            if min(parts[k].size) > 4 * STICKS_OUT:
                assert not is_covered(whole, tuple(parts[:k] + parts[k + 1 :]))


@pytest.mark.parametrize("place", np.linspace(-0.09, 0.09, 7))
def test_a_gap_anywhere_is_seen(place: float) -> None:
    cuts = [np.array([place]), np.array([0.05]), np.empty(0)]
    assert is_covered(box(WHOLE, at(0, 0, 0)), tuple(blocks(cuts, STICKS_OUT)))
    assert not is_covered(box((0.199, 0.299, 0.499), at(0, 0, 0)), tuple(blocks(cuts, 3 * STICKS_OUT)))


@pytest.mark.parametrize("seed", range(150))
def test_no_point_of_what_is_covered_lies_in_no_shape(seed: int) -> None:
    rng = np.random.default_rng(seed)
    parts = []
    for _ in range(rng.integers(2, 7)):
        pose = at(
            *rng.uniform(-0.1, 0.1, 3).tolist(), turned=Rotation.random(random_state=rng.integers(1 << 30))
        )
        kind = (ShapeType.BOX, ShapeType.CYLINDER, ShapeType.SPHERE)[rng.integers(3) * (seed % 2)]
        size = rng.uniform(0.1, 0.3, {ShapeType.BOX: 3, ShapeType.CYLINDER: 2, ShapeType.SPHERE: 1}[kind])
        parts.append(Geometry(kind, pose, tuple(size.tolist())))
    core = box(tuple(rng.uniform(0.05, 0.25, 3).tolist()), at(*rng.uniform(-0.05, 0.05, 3).tolist()))
    points = samples(core, rng, 4000)
    free = ~np.any([inside(one, points) for one in parts], axis=0)
    if is_covered(core, tuple(parts)):
        assert not free.any()
    elif seed % 2 == 0:  # of what is round a little is not counted
        near = samples(replace(core, size=tuple(1.01 * each for each in core.size)), rng, 40000)
        assert not np.all(np.any([inside(one, near) for one in parts], axis=0))


@pytest.mark.parametrize("apart", [0.0, 0.01])
def test_two_meshes_hold_a_box_together_where_nothing_is_between_them(tmp_path: Path, apart: float) -> None:
    bodies = []
    for side in (-1, 1):  # flat where they meet
        ball, file = trimesh.creation.icosphere(2, 0.2), tmp_path / f"{side}.obj"
        ball.vertices[:, 0] = side * np.maximum(side * ball.vertices[:, 0] + 0.17, apart / 2)
        ball.export(file)
        bodies.append(Geometry(ShapeType.MESH, at(0, 0, 0), (1.0, 1.0, 1.0), str(file), mesh_hash(file)))
        assert len(solids(bodies[-1])) == 1
    core = box((0.2, 0.1, 0.1), at(0, 0, 0))
    assert not any(is_covered(core, (one,)) for one in bodies)
    assert is_covered(core, tuple(bodies)) == (not apart)


def test_a_box_in_a_groove_that_few_pieces_of_a_mesh_fill_lies_in_no_body(tmp_path: Path) -> None:
    """Certification takes fine ones where the coarse pieces of two links touch: then it lets things in."""
    file, groove = tmp_path / "grooved.stl", 0.1
    parts = [
        ((0.1, 0.2, 0.2), (-0.1, 0, 0)),
        ((0.1, 0.2, 0.2), (0.1, 0, 0)),
        ((groove, 0.2, 0.1), (0, 0, -0.05)),
    ]
    blocks = [trimesh.creation.box(size).apply_translation(place) for size, place in parts]
    trimesh.util.concatenate(blocks).export(file)
    body = Geometry(ShapeType.MESH, at(0, 0, 0), (1.0, 1.0, 1.0), str(file), mesh_hash(file))
    assert len(solids(body, COARSE)) < len(solids(body, FINE))
    assert not is_covered(box((0.06, 0.1, 0.06), at(0, 0, 0.05)), (body,))
    assert is_covered(box((0.06, 0.1, 0.06), at(0, 0, -0.05)), (body,))


def test_a_box_in_one_box_hardly_sticks_out_and_in_others_by_what_is_tolerated() -> None:
    one, half, round_ = box(WHOLE, at(0, 0, 0)), box((0.1, 0.1, 0.1), at(0, 0, 0)), ROUND
    assert sticks_out(one, (one,)) == sticks_out(half, (round_, one)) < 1e-8
    beyond = box((WHOLE[0] + 1e-4, *WHOLE[1:]), at(0, 0, 0))
    assert is_covered(beyond, (one,))
    assert sticks_out(beyond, (one,)) == sticks_out(half, (round_,)) == STICKS_OUT
