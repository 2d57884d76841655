r"""Tipping: where the floor's force acts lies between the wheels (Vukobratović's zero-moment point).

About an edge of the wheels' hull with inward normal n through P: the floor can only push, so that
n · (z - P) F_z >= 0 for the point z of its force, where z F_z = (-M_y, M_x) for the moment M about the
point below the base's origin. The moment that tips is minus that.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.triples import Facts
from sdt_kg.twin import Twin
from services.dynamics.model import Array
from services.dynamics.robot.balls import Vectors
from services.dynamics.robot.load import Loads
from services.embodiment.proof_check.geometry.interval import Interval
from services.physics.model import Scene

FEWEST = 3
"""[1] Points of contact that span a polygon."""


@dataclass(frozen=True, slots=True, eq=False)
class Polygon:
    """What the wheels surely span, in the base's frame.

    Attributes:
        normals: Inward unit normals of the edges, shape (E, 2).
        offsets: n · p >= offset inside, shape (E,) [m].
        slack: By how much a point of contact may be off [m].
    """

    normals: Array
    offsets: Array
    slack: float


def tipping(scene: Scene, twin: Twin) -> tuple[Callable[[Loads], Interval] | None, str]:
    """The moment that tips the base over its worst edge [N m]; else None, and which data are missing."""
    facts = twin.entities.facts
    bodies = facts.iris(scene.robot_iri, "standsOn")
    if len(bodies) < FEWEST:
        return None, "since no data (sdt:standsOn) say where its wheels touch the floor"
    unknown, _ = unweighed(scene)
    if unknown:
        return None, f"since the model gives no mass of {', '.join(unknown[:4])}"
    slack = max(_within(facts, each) for each in bodies)
    polygon = _polygon(scene, [local_name(each) for each in bodies], slack)
    if polygon is None:
        return None, "since the bodies of sdt:standsOn lie on a line"
    return lambda loads: tipped(loads, polygon), ""


def _within(facts: Facts, body: Iri) -> float:
    """How far a wheel's point of contact may be from its body's origin [m].

    Raises:
        InputError: It is less than nothing, which would widen what the wheels span.
    """
    found = facts.number(body, "contactWithin", 0.0)
    if not 0 <= found < math.inf:
        said = f"sdt:contactWithin of {local_name(body)} is {found:g} m"
        raise InputError(said, allowed="0 or above, and finite")
    return found


def unweighed(scene: Scene) -> tuple[list[str], list[str]]:
    """Bodies that have a shape and no mass in the robot's model: those of the base, and all others."""
    bodies = scene.robot.mechanism.bodies
    base, _ = scene.robot.attached[scene.annotation.base_body]
    light = [each.name for each in bodies if each.collision and each.inertia is None]
    with_base = {name for name in light if scene.robot.attached[name][0] == base}
    return sorted(with_base), sorted(set(light) - with_base)


def _polygon(scene: Scene, names: list[str], slack: float) -> Polygon | None:
    at = scene.placements.move(scene.q((0.0, 0.0, 0.0), {}))
    base = at[int(scene.base[2]) + 1].inverse()
    points = []
    for name in names:
        joint, joint_T_body = scene.robot.attached[name]
        points.append((base * at[joint] * joint_T_body).translation[:2])
    try:
        hull = ConvexHull(np.array(points))
    except QhullError:
        return None
    # rows of `equations` are outward normal and offset: n · p + d <= 0 inside
    return Polygon(-hull.equations[:, :2], hull.equations[:, 2], slack)


def tipped(loads: Loads, polygon: Polygon) -> Interval:
    """Bounds over all spans of the moment over the worst edge, shape (C,)."""
    found = [
        _over(loads, normal, offset, polygon.slack)
        for normal, offset in zip(polygon.normals, polygon.offsets, strict=True)
    ]
    lows, highs = np.stack([each.lo for each in found]), np.stack([each.hi for each in found])
    return Interval(lows.max(axis=0), highs.max(axis=0))


def _over(loads: Loads, normal: Array, offset: float, slack: float) -> Interval:
    """Moment over one edge: linear in the handle's force, so that its ends suffice."""
    inward = loads.base.carried(np.array([*normal, 0.0]))
    # (-M_y, M_x) · n is M · (n_y, -n_x): the moment about the edge
    edge = Vectors(
        np.stack([inward.centre[:, 1], -inward.centre[:, 0], np.zeros(len(inward.radius))], axis=1),
        inward.radius,
    )
    own, pulled = edge.dot(loads.moment), edge.dot(loads.arm.cross(loads.along))
    moment = own.interval() + pulled.interval() * loads.force
    rises, weighs = loads.along.centre[:, 2], loads.floor.centre[:, 2]
    up = Interval(rises - loads.along.radius, rises + loads.along.radius)
    pressing = Interval(weighs - loads.floor.radius, weighs + loads.floor.radius) + up * loads.force
    span = len(rises)
    inner, outer = (Interval(np.full(span, at), np.full(span, at)) for at in (offset + slack, offset - slack))
    kept, held = moment - inner * pressing, moment - outer * pressing
    return Interval(-held.hi, -kept.lo)
