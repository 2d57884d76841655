"""What the certifier builds on is sound: pieces, kinematics, bounds on motion, distances, the sweep."""

from collections.abc import Callable

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # found through a .pth file
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from predicates.margins import LOOKED_UP_TO
from sdt_kg.load import load_twin
from sdt_kg.motion import BodyMotion
from services.embodiment.certify import Tolerances
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.sweep.clearance import PRECISION, Pairs, Sweep
from services.embodiment.certify.sweep.kinematics import Of
from services.embodiment.certify.sweep.pieces import (
    Pieces,
    Timeline,
    accelerations,
    hermite,
    positions,
    velocities,
)
from services.embodiment.certify.sweep.subject import Subject, subject
from services.physics.model import Scene

pytestmark = pytest.mark.oracle
Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def scene() -> Scene:
    twin = load_twin("b", ["pr2"])
    return Scene(twin, twin.robots[0])


def random_pieces(rng: np.random.Generator, count: int, nq: int, amplitude: float = 1.0) -> Pieces:
    times = np.cumsum(rng.uniform(0.1, 2, count))
    return hermite(times, rng.normal(size=(count, nq)) * amplitude, rng.normal(size=(count, nq)) * amplitude)


def random_subject(scene: Scene, seed: int) -> Subject:
    """The base, four joints of the robot and two of the kitchen move at random."""
    rng = np.random.default_rng(seed)
    count, nq = int(rng.integers(2, 7)), scene.model.nq
    robot = rng.choice(np.arange(scene.robot.first, nq), 4, replace=False)
    moving = np.concatenate((scene.base, robot, rng.choice(scene.base[0], 2, replace=False)))
    q = np.tile(scene.q((rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-3, 3)), {}), (count, 1))
    v, amplitude = np.zeros_like(q), rng.choice([0.02, 0.2, 1.0])
    q[:, moving] += np.cumsum(rng.normal(size=(count, len(moving))) * amplitude, axis=0)
    v[:, moving] = rng.normal(size=(count, len(moving))) * amplitude
    times = np.cumsum(rng.uniform(0.2, 2, count))
    pieces = hermite(times, scene.coupling.positions(q), scene.coupling.rates(v))
    return subject(scene, pieces, Tolerances())


def at(pieces: Pieces, times: Array) -> Array:
    """Positions, shape (M, nq)."""
    piece = np.minimum(np.searchsorted(pieces.start, times, side="right"), len(pieces.start)) - 1
    return pieces.at(piece, times - pieces.start[piece])[0]


def test_pieces_are_the_cubic_hermite_spline_and_their_extrema_exact() -> None:
    rng = np.random.default_rng(1)
    times = np.cumsum(rng.uniform(0.1, 2, 20))
    q, v = rng.normal(size=(2, 20, 5))
    pieces, spline = hermite(times, q, v), CubicHermiteSpline(times, q, v)
    candidates = (positions(pieces), velocities(pieces), accelerations(pieces))
    for order, (values, s) in enumerate(candidates):
        for n in range(19):
            dense = spline(np.linspace(times[n], times[n + 1], 2001)[1:-1], order)
            assert (values[:, n].max(axis=0) >= dense.max(axis=0) - 1e-9).all()
            assert (values[:, n].min(axis=0) <= dense.min(axis=0) + 1e-9).all()
            if order < 2:  # an acceleration at a sample belongs to the piece, the spline has the next one's
                there = np.diagonal(spline(times[n] + s[:, n], order), axis1=1, axis2=2)
                np.testing.assert_allclose(values[:, n], there, atol=1e-7)


@pytest.mark.parametrize("count", [2, 6, 9])
def test_spans_bound_the_motion_at_every_level(count: int) -> None:
    rng = np.random.default_rng(count)
    pieces = random_pieces(rng, count, 4)
    timeline = Timeline(pieces)
    for level in range(timeline.depth + 4):
        start, end = timeline.interval(level, np.arange(2**level))
        spans = timeline.spans(level, np.flatnonzero(end > start))
        assert spans.end.max() == timeline.end
        np.testing.assert_allclose((spans.end - spans.start).sum(), timeline.end - pieces.start[0])
        for u in range(len(spans.start)):
            dense = at(pieces, np.linspace(spans.start[u], spans.end[u], 50))
            assert (np.abs(dense - spans.q[u]) <= spans.shift[u] + 1e-9).all()


def test_kinematics_are_pinocchios(scene: Scene) -> None:
    checked = random_subject(scene, 3)
    timeline, data = checked.timeline, scene.model.createData()
    spans = timeline.spans(timeline.depth, np.array([0, 1]))
    placed = checked.kinematics.place(spans.q, spans.v)
    solids = np.arange(len(scene.solids))
    for u, q in enumerate(at(checked.pieces, spans.middle)):
        pin.forwardKinematics(scene.model, data, q)
        centres = checked.shapes.centres(placed, np.full(len(solids), u), solids)
        for one, centre in zip(scene.solids, centres, strict=True):
            np.testing.assert_allclose(centre, data.oMi[one.joint].act(one.centre), atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_no_point_of_a_body_moves_farther_than_its_bound(scene: Scene, seed: int) -> None:
    checked, rng = random_subject(scene, seed), np.random.default_rng(seed)
    timeline, kinematics, shapes = checked.timeline, checked.kinematics, checked.shapes
    for level in (0, timeline.depth, timeline.depth + 3):
        start, end = timeline.interval(level, np.arange(2**level))
        interval = rng.choice(np.flatnonzero(end > start))
        spans = timeline.spans(level, np.array([interval]))
        placed = kinematics.place(spans.q, spans.v)
        for one, other in rng.choice(len(scene.solids), (25, 2)):
            centre = shapes.centres(placed, np.zeros(1, dtype=np.intp), np.array([one]))
            ball = Of(int(shapes.carrier[one]), int(shapes.carrier[other]), centre, float(shapes.radius[one]))
            shift, turn = kinematics.bounds(spans, placed, ball)
            far, turned = farthest(scene, checked.pieces, spans.start[0], spans.end[0], one, other, rng)
            assert far <= shift[0] + 1e-9
            assert turned <= turn[0] + 1e-9


def farthest(  # noqa: PLR0917
    scene: Scene, pieces: Pieces, start: float, end: float, one: int, other: int, rng: np.random.Generator
) -> tuple[float, float]:
    """Farthest that a ball's points moved against another body since the middle, and its turn."""
    data, (i, j) = scene.model.createData(), (scene.solids[one].joint, scene.solids[other].joint)

    def relative(q: Array) -> Array:
        pin.forwardKinematics(scene.model, data, q)
        return data.oMi[j].actInv(data.oMi[i]).homogeneous

    direction = rng.normal(size=(20, 3))
    direction *= scene.solids[one].radius / np.linalg.norm(direction, axis=1)[:, None]
    points = np.hstack((scene.solids[one].centre + direction, np.ones((20, 1)))).T
    qs = at(pieces, np.linspace(start, end, 9))
    middle = relative(qs[4])
    change = [relative(q) - middle for q in qs]
    moved = max(float(np.linalg.norm((x @ points)[:3], axis=0).max()) for x in change)
    return moved, max(float(np.linalg.norm(x[:3, :3], 2)) for x in change)


@pytest.mark.parametrize("seed", range(6))
def test_the_sweep_finds_what_dense_sampling_finds(scene: Scene, seed: int) -> None:
    checked, rng = random_subject(scene, seed + 100), np.random.default_rng(seed)
    every = np.vstack((scene.self_pairs, scene.environment_pairs))
    shapes = every[rng.choice(len(every), 300, replace=False)]
    zero = np.zeros(len(shapes))
    sets = [Pairs(shapes, zero, zero, np.inf)]
    (found,) = Sweep(checked.timeline, checked.kinematics, checked.shapes, sets).run(1e-4)
    times = np.linspace(checked.pieces.start[0], checked.timeline.end, 60)
    dense = min(densely(scene, q, shapes) for q in at(checked.pieces, times))
    assert found.slack <= dense + PRECISION
    assert (found.first is not None) or dense >= 0
    if found.worst is not None:  # and what it reports is so
        (q,) = at(checked.pieces, np.array([found.worst.time]))
        assert densely(scene, q, np.array([found.worst.pair])) == pytest.approx(found.worst.value, abs=1e-5)


def densely(scene: Scene, q: Array, pairs: NDArray[np.intp]) -> float:
    """Smallest distance of the pairs at q, by Pinocchio's kinematics, cut off where balls are apart."""
    data = scene.model.createData()
    pin.forwardKinematics(scene.model, data, q)
    centres = np.array([data.oMi[one.joint].act(one.centre) for one in scene.solids])
    radii = np.array([one.radius for one in scene.solids])
    a, b = pairs.T
    apart = np.linalg.norm(centres[a] - centres[b], axis=1) - radii[a] - radii[b]
    smallest = LOOKED_UP_TO
    for k in np.argsort(apart):
        if apart[k] > smallest:
            break
        one, other = scene.solids[a[k]], scene.solids[b[k]]
        frames = [data.oMi[x.joint] * x.joint_T_shape for x in (one, other)]
        placed = [coal.Transform3s(frame.rotation, frame.translation) for frame in frames]
        kinds = {type(one.shape), type(other.shape)}
        assert kinds != {coal.Sphere, coal.Cylinder}, "its depth is not coal's, choose another seed"
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        smallest = min(smallest, coal.distance(one.shape, placed[0], other.shape, placed[1], request, result))
    return smallest


Support = Callable[[Array], Array]


def supports(rng: np.random.Generator, scale: float) -> list[tuple[object, Support]]:
    """Random shapes of every kind, and their support functions h(n) for directions of shape (K, 3)."""
    x, y, z = rng.uniform(0.1, 1, 3) * scale
    points = rng.normal(size=(30, 3)) * scale * rng.uniform(0.1, 1, 3)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(0, len(points))
    mesh.addVertices(points)
    mesh.endModel()
    mesh.buildConvexHull(True, "Qt")
    return [
        (coal.Box(x, y, z), lambda n: np.abs(n) @ np.array((x, y, z)) / 2),
        (coal.Sphere(x), lambda n: np.full(len(n), x)),
        (coal.Cylinder(x, z), lambda n: np.hypot(n[:, 0], n[:, 1]) * x + np.abs(n[:, 2]) * z / 2),
        (coal.Capsule(x, z), lambda n: x + np.abs(n[:, 2]) * z / 2),
        (mesh.convex, lambda n: (n @ points.T).max(axis=1)),
    ]


def signed_distance(separation: Callable[[Array], Array], rng: np.random.Generator) -> float:
    """Largest separation over all directions: distance of convex bodies, or minus their depth."""
    directions = rng.normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    values = separation(directions)
    best = -np.inf
    for start in np.argsort(values)[-8:]:
        n, value, step = directions[start], values[start], 0.1
        while step > 1e-8:
            tried = n + step * rng.normal(size=(60, 3))
            tried /= np.linalg.norm(tried, axis=1)[:, None]
            separations = separation(tried)
            if separations.max() > value:
                value, n = separations.max(), tried[separations.argmax()]
            else:
                step *= 0.6
        best = max(best, float(value))
    return best


@pytest.mark.parametrize("seed", range(12))
def test_coals_distance_is_never_too_large(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one_scale, other_scale = 10 ** rng.uniform(-1.5, 0, 2)
    one_R, other_R = Rotation.from_quat(rng.normal(size=(2, 4))).as_matrix()
    between = rng.normal(size=3) * (one_scale + other_scale) * 0.5
    frames = coal.Transform3s(one_R, np.zeros(3)), coal.Transform3s(other_R, between)
    for one, one_h in supports(rng, one_scale):
        for other, other_h in supports(rng, other_scale):

            def separation(n: Array, one_h: Support = one_h, other_h: Support = other_h) -> Array:
                return n @ between - one_h(n @ one_R) - other_h(-n @ other_R)

            request, result = coal.DistanceRequest(), coal.DistanceResult()
            measured = coal.distance(one, frames[0], other, frames[1], request, result)
            exact = signed_distance(separation, rng)
            assert measured <= exact + 2e-4 * max(one_scale, other_scale)  # the search is a lower bound
            if {type(one), type(other)} != {coal.Sphere, coal.Cylinder} or exact > 0:
                assert measured == pytest.approx(exact, abs=2e-4)


@pytest.mark.parametrize(("speed", "equal"), [(0.0, True), (0.05, False)])
def test_joints_of_one_motor_move_equally_between_samples_too(speed: float, equal: bool) -> None:
    twin = load_twin("b", ["stretch"])
    scene = Scene(twin, twin.robots[0])
    joints, still = scene.annotation.coupled[0], np.zeros((3, 3))
    q, v = np.full((3, len(joints)), 0.06), np.zeros((3, len(joints)))
    v[1, 0], v[1, -1] = speed, -speed
    motion = BodyMotion(twin.robots[0], "", joints, np.array([0.0, 2.0, 4.0]), still, q, v, still)
    _, findings = whole_motion(scene, motion, Tolerances())
    assert bool(findings.violations) is not equal
    if not equal:
        worst = max(findings.violations, key=lambda each: each.excess)
        assert "share one motor" in worst.reason
        assert worst.excess == pytest.approx(2 * speed * 2.0 * 4 / 27)  # Hermite's bump, h = 2 s
        assert worst.time == pytest.approx(2.0 * 2 / 3)
