"""The certifier's compiled loops are loaded, or compiled, before any clock runs and before workers begin."""

import numpy as np

from services.embodiment.certify.held.moved import farthest, press, slope, tolerated
from services.embodiment.certify.sweep.clearance import Pairs, Sweep
from services.embodiment.certify.sweep.kinematics import Of
from services.embodiment.certify.sweep.pieces import hermite
from services.embodiment.certify.sweep.subject import subject
from services.embodiment.certify.tolerances import Tolerances
from services.physics.geometry.convex import ROOM
from services.physics.model import Scene

FAR = 1e6  # [m] a distance that nothing keeps, so that every loop has something to look at


def warm(scene: Scene) -> None:
    """Every compiled function has run once, with the types in which it is used."""
    q = np.tile(scene.q((0.0, 0.0, 0.0), {}), (2, 1))
    q[1, scene.base[0]] += 1.0
    pieces = hermite(np.arange(2.0), q, np.zeros_like(q))
    checked = subject(scene, pieces, Tolerances())
    pairs = np.concatenate((scene.environment_pairs, scene.self_pairs))[:1]
    least = np.full(len(pairs), FAR)
    sets = [Pairs(pairs, least, least, np.inf)]
    Sweep(checked.timeline, checked.kinematics, checked.shapes, sets).run(FAR)
    first = checked.pieces.columns(pieces.moving).c[:2, 0]
    placed = checked.kinematics.place(first[:1], first[1:])
    checked.pieces.at(np.zeros(1, np.intp), np.zeros(1))
    spans = checked.timeline.spans(0, np.zeros(1, np.intp))
    checked.kinematics.bounds(spans, placed, Of(0, 0, np.zeros((1, 3)), 0.0))
    both, row, way = pairs.ravel(), np.array([[0, 1]]), np.zeros(3)
    posed = both, *checked.shapes.middles(placed, both)
    sides, asked, room = np.zeros((4, 3)), (0.0, 0.0, 0.0), (np.empty(3), np.zeros(ROOM))
    press(checked.shapes.convex, row, posed, way, sides, *asked, room)
    tolerated(checked.shapes.convex, (row, row), posed, (way, way), sides, *asked, room)
    farthest(checked.shapes.convex, row, posed, way, *asked, 0.0, room)
    slope(checked.shapes.convex, row, posed, way, sides, 0.0, 1.0, room)
