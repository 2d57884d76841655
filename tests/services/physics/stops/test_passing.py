"""Boxes of which one is moved by a joint: where they are said not to meet they do not."""

import coal  # pyright: ignore[reportMissingImports]  # found through a .pth file
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.physics.stops.passing import Boxes, Way, may_meet

PAIRS, PIECES, INSIDE = 300, 8, 5
LEAST = 0.01  # [m]
END = {True: 0.5, False: 1.6}  # [m or rad] of the actuated joint
RATE = -1.5


def at(way: Way, boxes: Boxes, position: float) -> Boxes:
    """The boxes when the actuated joint has moved by this."""
    gone = way.rate * position
    if way.slides:
        return Boxes(boxes.rotation, boxes.middle + gone * way.axis, boxes.half)
    turn = Rotation.from_rotvec(gone * way.axis).as_matrix()
    return Boxes(turn @ boxes.rotation, (boxes.middle - way.origin) @ turn.T + way.origin, boxes.half)


def boxes(rng: np.random.Generator) -> Boxes:
    turned = Rotation.random(PAIRS, rng).as_matrix()
    return Boxes(turned, rng.uniform(-0.4, 0.4, (PAIRS, 3)), rng.uniform(0.01, 0.3, (PAIRS, 3)))


@pytest.mark.parametrize("slides", [True, False])
def test_boxes_are_no_deeper_than_allowed_on_pieces_on_which_they_cannot_meet(slides: bool) -> None:
    rng = np.random.default_rng(7)
    resting, moved, axis = boxes(rng), boxes(rng), rng.normal(size=3)
    way = Way(axis / np.linalg.norm(axis), rng.uniform(-0.2, 0.2, 3), slides, RATE)
    half = END[slides] / PIECES / 2
    middles = 2 * half * (np.arange(PIECES) + 0.5)
    placed = [at(way, moved, float(middle)) for middle in middles]
    pieces = Boxes(
        np.array([each.rotation for each in placed]),
        np.array([each.middle for each in placed]),
        np.array([each.half for each in placed]),
    )
    meet = may_meet(way, half, pieces, resting, np.full(PAIRS, LEAST))
    assert 0.2 < meet.mean() < 0.9
    deepest = {True: 0.0, False: 0.0}
    for k, middle in enumerate(middles):
        for position in middle + half * np.linspace(-1, 1, INSIDE):
            there = at(way, moved, float(position))
            for n in range(PAIRS):
                deepest[bool(meet[k, n])] = max(deepest[bool(meet[k, n])], depth(there, resting, n))
    assert deepest[False] <= LEAST + 1e-6
    assert deepest[True] > 10 * LEAST


def depth(one: Boxes, other: Boxes, n: int) -> float:
    """By how much the n-th boxes overlap [m]; negative where they are apart."""
    shapes = [coal.Box(*(2 * each.half[n])) for each in (one, other)]
    poses = [coal.Transform3s(each.rotation[n], each.middle[n]) for each in (one, other)]
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return -float(coal.distance(shapes[0], poses[0], shapes[1], poses[1], request, result))
