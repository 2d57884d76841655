"""Collision geometry as coal shapes."""

import hashlib
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import UrdfError
from sdt_kg.mechanism import Geometry, ShapeType
from sdt_kg.urdf import meshes, obj, unread
from sdt_kg.urdf.meshes import metres, triangles_of
from services.physics.geometry import fans, hulls
from services.physics.geometry.fans import FEW, cones_of
from services.physics.geometry.hulls import COARSE, Fineness, convex_pieces
from services.physics.geometry.kept import Array, kept

AGREED = 1e-5  # [1] share of a mesh's size by which two readers' bounds may differ: of single precision
FLAT = 1e-6  # [m] a mesh thinner than this has no volume: qhull crashes on it
LONGEST = 100.0  # [m] of a mesh, as long as the floor: handles of 0.1 m in millimetres are longer
SHORTEST = 1e-3  # [m] of a mesh: walls in metres that are scaled as if in millimetres are shorter
SAID = 60  # signs of a line that an error shows
PADDING = 1e-4  # [m] how far the hull of a flat mesh stands out on both sides


def solids(geometry: Geometry, fineness: Fineness = COARSE) -> tuple[coal.CollisionGeometry, ...]:
    """Shapes that contain the geometry's surface: a primitive as it is, a mesh as convex pieces.

    For robot links: what is certified free with the pieces is free with the mesh.
    """
    if geometry.shape is ShapeType.MESH:
        return _hulls(geometry.mesh_file, geometry.mesh_hash, geometry.size, fineness)
    return (_primitive(geometry),)


def surface(geometry: Geometry) -> tuple[coal.CollisionGeometry, ...]:
    """Shape with the geometry's surface: primitives as they are, a mesh as its triangles.

    For kitchens, whose cabinets and drawers are hollow: a hull would fill them. A body that lies
    wholly inside a closed mesh touches no triangle and reads as free; it cannot get there from
    outside without crossing the surface, which a check of the motion between samples sees, and
    whether it begins there is asked of `geometry.inside`. The depth of a penetration is that into
    single triangles: too little, never too much.
    """
    if geometry.shape is ShapeType.MESH:
        return (_triangles(geometry.mesh_file, geometry.mesh_hash, geometry.size),)
    return (_primitive(geometry),)


def _primitive(geometry: Geometry) -> coal.CollisionGeometry:
    kinds = {
        ShapeType.BOX: coal.Box,
        ShapeType.SPHERE: coal.Sphere,
        ShapeType.CYLINDER: coal.Cylinder,
        ShapeType.CAPSULE: coal.Capsule,
    }
    shape = kinds[geometry.shape](*geometry.size)
    shape.computeLocalAABB()
    return shape


@lru_cache(maxsize=1024)
def _triangles(mesh_file: str, mesh_hash: str, scale: tuple[float, ...]) -> coal.BVHModelBase:
    # The hash is part of the key: a file that changed is another mesh.
    mesh = _loaded(mesh_file, mesh_hash, scale, coal.BV_OBBRSS)
    mesh.computeLocalAABB()
    return mesh


def _loaded(
    mesh_file: str, mesh_hash: str, scale: tuple[float, ...], tree: coal.NODE_TYPE
) -> coal.BVHModelBase:
    """The mesh that the model names: its hash is in every verdict, and what is kept is found by it.

    Raises:
        UrdfError: The file is no mesh, or another one than when the model was read.
    """
    meshes.check_whole(Path(mesh_file), mesh_file)
    try:
        mesh = _of_plain(mesh_file, scale) or _by_assimp(mesh_file, scale, tree)
    except (RuntimeError, ValueError) as error:
        said = " ".join(str(error).rpartition("message:")[2].split())  # before it: where in coal's sources
        raise UrdfError(
            f"mesh {mesh_file} cannot be read: {said}", allowed=", ".join(meshes.WHOLE)
        ) from error
    if not np.isfinite(mesh.vertices()).all():  # its triangle would touch nothing
        raise UrdfError(f"mesh {mesh_file} has a vertex that is no point", allowed="finite coordinates")
    _check_size(mesh_file, float(np.ptp(mesh.vertices(), axis=0).max()))
    if meshes.mesh_hash(Path(mesh_file)) != mesh_hash:
        raise UrdfError(
            f"mesh {mesh_file} is another file than when its model was read",
            remedy="read the model again, with a service by starting it again; or put the file back",
        )
    return mesh


def _of_plain(mesh_file: str, scale: tuple[float, ...]) -> coal.BVHModelBase | None:
    """The mesh of a plain OBJ file; None of any other."""
    path = Path(mesh_file)
    found = obj.plain(path.read_bytes()) if path.suffix.lower() == obj.SUFFIX and path.is_file() else None
    return None if found is None else Triangles(found[0] * np.array(scale), found[1])


def _by_assimp(mesh_file: str, scale: tuple[float, ...], tree: coal.NODE_TYPE) -> coal.BVHModelBase:
    """The mesh as Assimp reads it.

    Raises:
        UrdfError: It would read another shape than the file says, or for ever.
        ValueError, RuntimeError: It cannot read it.
    """
    path = Path(mesh_file)
    if path.is_file() and (found := unread.unread(path.suffix, path.read_bytes())):
        line, wrong, remedy = found
        said = line.decode(errors="replace").strip()[:SAID]
        raise UrdfError(f"mesh {mesh_file} cannot be read as written: '{said}' {wrong}", remedy=remedy)
    mesh = coal.MeshLoader(tree).load(mesh_file, np.array(scale) * metres(path))
    return _whole(mesh, mesh_file, scale)


def _whole(mesh: coal.BVHModelBase, mesh_file: str, scale: tuple[float, ...]) -> coal.BVHModelBase:
    """The mesh, each triangle between the points that its file says.

    Of several meshes in a file (one for each material or node) coal has all points, but may number those of
    a triangle from where another mesh begins: then some are of no triangle, and the file is read otherwise.

    Raises:
        UrdfError: What is read then is not where those points are.
    """
    theirs, numbers = faces_of(mesh)
    if len(np.unique(numbers)) == len(theirs):
        return mesh
    points, faces = triangles_of(Path(mesh_file))
    points = points * np.array(scale)
    bounds = [(each.min(axis=0), each.max(axis=0)) for each in (theirs, points)]
    if not np.allclose(*bounds, rtol=0, atol=AGREED * np.abs(bounds[0]).max()):
        raise UrdfError(
            f"mesh {mesh_file} holds several meshes, which two readers place differently",
            allowed="one mesh in a file",
            remedy="join them where the file was made, or export it as STL",
        )
    return Triangles(points, faces)


class Triangles(coal.BVHModelOBBRSS):
    """A mesh, with what it was made of: coal gives triangles back one by one.

    Attributes:
        points: Shape (V, 3) [m].
        faces: The three of each triangle, shape (M, 3).
    """

    def __init__(self, points: NDArray[np.float64], faces: NDArray[np.int64]) -> None:
        super().__init__()
        self.points, self.faces = points, faces
        self.beginModel(len(faces), len(points))
        self.addVertices(points)
        self.addTriangles(faces)
        self.endModel()
        self.computeLocalAABB()


def _check_size(mesh_file: str, size: float) -> None:
    """A mesh is in metres: one in another unit is far from all that it stands for, and stops nothing.

    Raises:
        UrdfError: It is as long [m] as nothing in a kitchen is.
    """
    if size > LONGEST:
        remedy = 'a file in millimetres needs scale="0.001 0.001 0.001" in collision geometry too'
    elif size < SHORTEST:
        remedy = "take the scale away if the file is in metres"
    else:
        return
    allowed = f"{SHORTEST:g} to {LONGEST:g} m"
    raise UrdfError(f"mesh {mesh_file} is {size:.4g} m long, as scaled", allowed=allowed, remedy=remedy)


@lru_cache(maxsize=1024)
def _hulls(
    mesh_file: str, mesh_hash: str, scale: tuple[float, ...], fineness: Fineness
) -> tuple[coal.ConvexBase, ...]:
    def cut() -> list[Array]:
        pieces = convex_pieces(_corners(mesh_file, mesh_hash, scale), fineness)
        return [array for points in pieces for array in _hulled(points)]

    arrays = iter(kept((_code(), Path(mesh_file).suffix.lower(), mesh_hash, scale, fineness), cut))
    return tuple(map(Hull, arrays, arrays, arrays, arrays))


class Hull(coal.Convex):
    """A convex hull that was made before, with the vertices of its cones (`geometry.fans`).

    Attributes:
        starts: Where those of each cone begin in `rows`, shape (CONES + 1,); empty where there are few.
        rows: Of its points, shape (K,).
    """

    def __init__(self, points: Array, faces: Array, starts: Array, rows: Array) -> None:
        own, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
        own.extend(points)
        triangles.extend([coal.Triangle(*each) for each in faces.tolist()])
        super().__init__(own, triangles)
        self.computeLocalAABB()
        self.starts, self.rows = (np.asarray(each, np.int64).ravel() for each in (starts, rows))


def _hulled(points: NDArray[np.float64]) -> tuple[Array, Array, Array, Array]:
    """What a `Hull` is made of, about points, shape (K, 3)."""
    # Twice: points of hulls have volume, and the second hull has them in the order that it keeps.
    whole = hull_of_solid(np.array(hull(points).points()))
    corners, box, nothing = np.array(whole.points()), whole.aabb_local, np.empty((0, 1), np.int64)
    faces = [whole.polygons(i) for i in range(whole.num_polygons)]
    triangles = np.array([(face[0], face[1], face[2]) for face in faces], np.int64)
    if len(corners) <= FEW:
        return corners, triangles, nothing, nothing
    starts, rows = cones_of(corners - (box.min_ + box.max_) / 2)
    return corners, triangles, starts[:, None], rows[:, None]


@cache
def _code() -> str:
    """Hash of the code that makes pieces, and the version of what reads meshes and makes hulls."""
    sources = (Path(__file__), *(Path(str(each.__file__)) for each in (fans, hulls, meshes, obj, unread)))
    return hashlib.sha256(b"".join(each.read_bytes() for each in sources)).hexdigest() + version("coal")


def _corners(mesh_file: str, mesh_hash: str, scale: tuple[float, ...]) -> NDArray[np.float64]:
    """Triangles of a mesh, shape (M, 3, 3) [m]."""
    # The cheapest tree: nothing is asked of it.
    return _read(_loaded(mesh_file, mesh_hash, scale, coal.BV_AABB))


@lru_cache(maxsize=1024)
def corners(mesh: coal.BVHModelBase) -> NDArray[np.float64]:
    """Triangles of a mesh in its own frame, shape (M, 3, 3) [m]; kept, so neither is to be changed."""
    return _read(mesh)


def _read(mesh: coal.BVHModelBase) -> NDArray[np.float64]:
    points, faces = faces_of(mesh)
    return points[faces]


def faces_of(mesh: coal.BVHModelBase) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Points of a mesh in its own frame, shape (V, 3) [m], and the three of each triangle, shape (M, 3).

    They may be its own, so neither is to be changed.
    """
    if isinstance(mesh, Triangles):
        return mesh.points, mesh.faces
    faces = (mesh.tri_indices(i) for i in range(mesh.num_tris))
    return np.array(mesh.vertices()), np.array([(face[0], face[1], face[2]) for face in faces], np.intp)


def hull(points: NDArray[np.float64]) -> coal.ConvexBase:
    """Convex hull of points, shape (K, 3); what is flat gets a thickness of 2 · PADDING."""
    return hull_of_solid(with_volume(points))


def hull_of_solid(points: NDArray[np.float64]) -> coal.ConvexBase:
    """Convex hull of points that do not lie in a plane."""
    corners = coal.StdVec_Vec3s()
    corners.extend(points)
    hull = coal.Convex.convexHull(corners, True, "Qt")
    hull.computeLocalAABB()
    return hull


def with_volume(points: NDArray[np.float64], flat: float = FLAT) -> NDArray[np.float64]:
    """The points, and where they are thinner than `flat` [m] copies on both sides."""
    _, spread, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    most = 2 * flat * np.sqrt(len(points))  # of what is so flat, and rounded
    for axis in axes[spread < most]:
        if np.ptp(points @ axis) < flat:
            points = np.vstack((points + PADDING * axis, points - PADDING * axis))
    return points
