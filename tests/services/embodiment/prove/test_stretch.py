"""How far a grasp box can be from a joint where what is behind that is bent: no posture has it farther."""

import numpy as np
import pytest

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import Arm, make_arm
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement
from services.embodiment.proof_check.geometry.shapes import SIGNS
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.stretch import stretches
from services.embodiment.proof_check.target import Target
from services.embodiment.proof_check.tree import Goal, refuted_boxes
from services.embodiment.prove.tree.divided import divided
from tests.services.embodiment.prove.test_reach import arms
from tests.services.embodiment.prove.test_swing import JOINTS, chain

BOXES = 30
INSIDE = 40  # positions that are tried in each box; `make soak` tries more
NEAR = 1e-6  # [m] boxes are some 0.1 µm wider than what they are about
BENT = 0.5  # [rad] the least that the elbow below is bent


def said(arm: Arm, middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """How far the grasp box is at most from each joint but the last in each box, shape (L, n - 1)."""
    tool, swing = arm.chain.swing(middle, half)
    grasp = Placement(tool.rotation, apply(tool.rotation, exact(arm.middle)) + tool.translation)
    return np.stack([stretches(arm, k, swing, grasp) for k in range(len(arm.chain.links) - 1)], axis=1)


def far(arm: Arm, q: np.ndarray) -> np.ndarray:
    """How far its farthest corner is from each joint but the last, shape (L, n - 1)."""
    origins, _, tool = arm.chain.frames(q)
    corners = apply(tool.rotation[:, None], exact(arm.middle + SIGNS * arm.half)) + tool.translation[:, None]
    gaps = corners.middle[:, :, None] - origins.middle[:, None, :-1]
    return np.linalg.norm(gaps, axis=3).max(axis=1)


def any_arm(rng: np.random.Generator) -> Arm:
    """Hinges, and slides among them, of any direction, with a box of any size in hand."""
    anyhow, _ = chain(rng)
    return make_arm("any", anyhow, rng.normal(size=3) * 0.1 + SIGNS * rng.uniform(0, 0.15, 3), 0)


@pytest.mark.parametrize("width", [1e-3, 0.03, 0.3, 1.5])
@pytest.mark.parametrize("seed", range(3))
def test_no_posture_in_a_box_has_it_farther(width: float, seed: int) -> None:
    check_any(width, seed, INSIDE)


def check_any(width: float, seed: int, inside: int) -> None:
    """No position in boxes of any arm has its grasp box farther from a joint than is said of the boxes."""
    rng = np.random.default_rng(seed)
    arm = any_arm(rng)
    middle, half = rng.uniform(-2, 2, (BOXES, JOINTS)), width * rng.random((BOXES, JOINTS))
    most = said(arm, middle, half)
    for _ in range(inside):
        q = middle + half * rng.choice([-1.0, 1.0, rng.uniform(-1, 1)], half.shape)
        assert (far(arm, q) <= most + NEAR).all()


@pytest.mark.parametrize("robot", ["pr2", "tiago_dual", "stretch"])
def test_no_posture_of_a_robot_has_it_farther(robot: str) -> None:
    check_robot(robot, INSIDE)


def check_robot(robot: str, inside: int) -> None:
    """The same of a robot's arms."""
    rng = np.random.default_rng(1)
    for arm in arms(robot):
        low, high = arm.chain.ranges()
        middle = rng.uniform(low, high, (BOXES, len(low)))
        half = (high - low) / 2 * rng.choice([0.5, 0.1, 0.01], (BOXES, len(low)))
        most = said(arm, middle, half)
        for _ in range(inside):
            q = middle + half * rng.uniform(-1, 1, half.shape)
            assert (far(arm, q) <= most + NEAR).all()


def test_of_one_posture_it_is_known_how_far_it_is() -> None:
    rng = np.random.default_rng(2)
    arm = any_arm(rng)
    q = rng.uniform(-2, 2, (BOXES, JOINTS))
    assert said(arm, q, np.zeros_like(q)) == pytest.approx(far(arm, q), abs=NEAR)


def bent_arm() -> Arm:
    """Two links of 1 m; shoulder and wrist turn anyhow, the elbow is never straight. In hand is a point."""
    across, along = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    one = Placement(HERE.rotation, exact([1.0, 0.0, 0.0]))
    links = (
        Link("pan", HERE, across, True, -3.2, 3.2),
        Link("roll", HERE, along, True, -3.2, 3.2),
        Link("elbow", one, across, True, BENT, 2.0),
        Link("wrist", one, along, True, -3.2, 3.2),
    )
    return make_arm("any", Chain(links, HERE), np.zeros((8, 3)), 0)


def handle(far_off: float) -> Target:
    """A small one, so far from the shoulder along x."""
    size = 0.01
    at = Placement(HERE.rotation, exact([far_off + size, 0.0, 0.0]))
    return Target((at,), np.full((1, 3), size), np.zeros(1))


REACH = 2 * np.cos(BENT / 2)
"""[m] As far as it comes."""


@pytest.mark.parametrize(("beyond", "nodes"), [(1e-3, 400), (1e-2, 100)])
def test_few_boxes_show_that_an_arm_which_is_never_straight_falls_short(beyond: float, nodes: int) -> None:
    # Its links are 2 m long in all, so lengths do not show it, and its shoulder turns every way.
    arm = bent_arm()
    assert arm.reach[1] == pytest.approx(2.0, abs=1e-5)
    goal = Goal(arm, handle(REACH + beyond), (), level=False)
    box = arm.chain.ranges()
    tree = divided(goal, *box, nodes)
    assert tree is not None
    assert refuted_boxes(goal, iter(tree), *box) == sum(node >= LEAF for node in tree)


def test_what_it_does_reach_is_not_refuted_by_that_tree() -> None:
    arm = bent_arm()
    box = arm.chain.ranges()
    tree = divided(Goal(arm, handle(REACH + 1e-3), (), level=False), *box, 400)
    assert tree is not None
    within = Goal(arm, handle(REACH - 1e-4), (), level=False)
    with pytest.raises(InputError, match="can come as near as"):
        refuted_boxes(within, iter(tree), *box)
    assert divided(within, *box, 20_000) is None
