r"""Grasps of a set: how the hand is about a bar, in cells that trees of the arm refute one by one.

A grasp set is data: the fingers close across a bar of the handle, and the hand comes from the front. With
the bar's direction b and o, away from the front, and with :math:`c = o \times b`, a grasp has the tool's
approach and closing direction, of either sign, along

.. math:: a = \cos\tau\,(\sin\varphi\, c - \cos\varphi\, o) + \sin\tau\, b,
          \qquad y = \pm(\cos\varphi\, c + \sin\varphi\, o),

and its origin at the bar's middle + s b + d a: `place` s, `pitch` :math:`\varphi`, `tilt` :math:`\tau` and
`depth` d, each between its ends. So these are four joints of a chain from the bar to the tool, and a cell of
grasps is a box of their positions, in which what the tool carries moves no farther than `Swing` says. Refuted
are all motions that hold the bar in such a grasp, to within `tool_position` and `tool_angle` once the
container moves, as certification has it. Nothing else is asked of fingers and handle.

In a cell the tool's origin and the wrist, the origin of the arm's last joint, are each in a box, and the
tool's axes point along directions of the world to within intervals (`facing.py`). A tree of the arm's joints
refutes all of that together, or by cores that meet something solid.

Nodes are read in preorder, first of grasps with the one sign, then of those with the other: below 4 is the
coordinate that is halved, in the order above, lower half first; `LEAF` stands before a tree of the arm, and
`HAND` before one of these four joints in the cell, whose leaves name cores of the hand that meet something.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm, Beside, make_arm
from services.embodiment.proof_check.facing import Facing
from services.embodiment.proof_check.geometry.interval import apply, exact
from services.embodiment.proof_check.geometry.levers import lever_of
from services.embodiment.proof_check.geometry.mechanics import HERE, SHORTER, Chain, Link, Placement, Swing
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import WORLD, Around
from services.embodiment.proof_check.places import wrist_of
from services.embodiment.proof_check.proof.claim import DEPTH, PITCH, TILT, Bar
from services.embodiment.proof_check.proof.content import LEAF
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.target import Target
from services.embodiment.proof_check.tree import Goal, cells_of, refuted_boxes, refuted_limb

Array = NDArray[np.float64]

OFF = 1e-4  # [m, rad] a grasp may be off the set by, for rounding
NEARLY = 1e-9  # [1] unit vectors at right angles are off by no more
BESIDE = 0.002  # [m] out of a box about the handle a bar's middle line may be
HAND = LEAF + 1
SIGNS = (1.0, -1.0)
"""Of the closing direction."""


class Grasps:
    """All grasps of a bar by one gripper, with the container at one value.

    Args:
        statement: What is to be refuted.
        arm: The gripper's.
        bar: Of the handle.
        value: Of the container [rad or m].

    Raises:
        InputError: The base is free, or the handle has no such bar.
    """

    def __init__(self, statement: Statement, arm: Arm, bar: Bar, value: float) -> None:
        if statement.level:
            raise InputError("a proof about a set of grasps, with a free base", allowed="a fixed base")
        kept = statement.tolerances
        chain, q, off = statement.before_handle(value)
        origins, axes, joint = Chain(chain.links, HERE).frames(q)
        hinges = np.array([link.turns for link in chain.links])
        frame = _frame(bar)
        self._bar = Placement(joint.rotation[0], joint.translation[0]) @ frame
        _in_handle(bar, [(chain.end @ at, half) for at, half in statement.handle_boxes()])
        last = arm.chain.end.inverse().translation  # the last joint's origin, seen from the tool
        far = float(np.linalg.norm(frame.translation.middle)) + bar.reach + DEPTH + float(last.norm().hi)
        levers = lever_of(origins, axes, joint.translation, chain.links) + np.where(hinges, far, 0.0)
        self._shift, self._turned = float((levers * off).sum()), float(off[hinges].sum())
        slips = value != statement.twin.state[statement.container.joint]
        self._slip, self._turn = (kept.tool_position, kept.tool_angle) if slips else (0.0, 0.0)
        tool = make_arm(arm.gripper, arm.chain, np.zeros((8, 3)), 0)
        self._goal = Goal(
            replace(tool, cores=arm.cores),
            Target((), np.zeros((0, 3)), np.zeros(0)),
            statement.around(arm, value),
            level=False,
        )
        self._wrist, self._seen = wrist_of(arm), last.middle
        self.low = np.array([-bar.reach, -PITCH, -TILT, -DEPTH])
        self.high = -self.low
        self._cores, self._around = self._of_hand(arm, self._goal.around)

    def goal(self, sign: float, low: Array, high: Array) -> Goal:
        """What is to be refuted of the arm whose hand has a grasp in a cell, lower and upper ends (4,)."""
        middle = (low + high) / 2
        half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
        tool, swing = self._to_tool(sign).swing(middle[None], half[None])
        ways = tool.rotation.middle[0].T * SHORTER
        target, wrist = (self._box(tool, swing, ways, point) for point in (np.zeros(3), self._seen))
        return replace(
            self._goal, target=target, wrist=(self._wrist, wrist), facing=self._facing(tool, swing, ways)
        )

    def hand(self, sign: float) -> Beside:
        """The hand alone, with the bar's place, pitch, tilt and depth for joints, against the kitchen."""
        alone = make_arm("hand", self._to_tool(sign), np.zeros((8, 3)), 0)
        return Beside(replace(alone, cores=self._cores), self._around, len(self.low))

    def _of_hand(self, arm: Arm, around: tuple[Around, ...]) -> tuple[tuple[Core, ...], tuple[Around, ...]]:
        """Cores that the last joint carries, seen from the tool, less what it slips; and what they meet."""
        last, back = len(arm.chain.links) - 1, arm.chain.end.inverse()
        own = [k for k, core in enumerate(arm.cores) if core.link == last]
        found = list[Core]()
        for core in (arm.cores[k] for k in own):
            at = back @ core.middle
            less = self._off(float(at.translation.norm().hi + np.linalg.norm(core.half)))
            found.append(Core(core.body, len(self.low) - 1, at, np.maximum(core.half - less, 0.0)))
        still = (replace(one, keeps=one.keeps[own]) for one in around if one.carrier == WORLD)
        return tuple(found), tuple(still)

    def _off(self, far: float) -> float:
        """How far a point so far from the tool's origin may be from where a grasp has it [m]."""
        return self._slip + OFF + far * (OFF + self._turn + self._turned) + self._shift + ROUNDING

    def _to_tool(self, sign: float) -> Chain:
        """The bar's place, pitch, tilt and depth as joints, from the world to the tool."""
        ends = self.low, self.high
        axes = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
        names, turns = ("place", "pitch", "tilt", "depth"), (False, True, True, False)
        links = tuple(
            Link(name, HERE if k else self._bar, axes[k], turns[k], float(ends[0][k]), float(ends[1][k]))
            for k, name in enumerate(names)
        )
        hand = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, sign], [0.0, sign, 0.0]])
        return Chain(links, Placement(exact(hand), exact(np.zeros(3))))

    def _box(self, tool: Placement, swing: Swing, ways: Array, point: Array) -> Target:
        """Where a point of the tool's frame (3,) is in a cell: a box along its axes in the middle."""
        at = Placement(tool.rotation, apply(tool.rotation, exact(point)) + tool.translation)
        wide = swing.along(ways, at, np.zeros(3))
        slack = self._off(float(np.linalg.norm(point)))
        half, place = wide + slack, Placement(tool.rotation[0], at.translation[0])
        return Target((place,), half[None], np.array([slack]))

    def _facing(self, tool: Placement, swing: Swing, ways: Array) -> Facing:
        """How the tool is turned in a cell."""
        d, u = np.repeat(ways, 3, axis=0), tool.rotation.T[0, [0, 1, 2] * 3]
        at, moved = (exact(d) * u).total(), swing.turned(d, u) + self._turn + OFF + self._turned
        low, high = (at.lo - moved).reshape(3, 3), (at.hi + moved).reshape(3, 3)
        return Facing(ways, low, high)


def _frame(bar: Bar) -> Placement:
    """The bar's middle and its directions outward, along and across, in the frame of the handle's joint.

    Raises:
        InputError: They are no unit vectors at right angles.
    """
    outward, along = np.array(bar.outward), np.array(bar.along)
    turn = np.stack((outward, along, np.cross(outward, along)), axis=1)
    if not np.abs(turn.T @ turn - np.eye(3)).max() <= NEARLY or not bar.reach >= 0.0:
        raise InputError("a bar without directions", allowed="unit vectors along it and away from the front")
    return Placement(exact(turn), exact(bar.centre))


def _in_handle(bar: Bar, boxes: list[tuple[Placement, Array]]) -> None:
    """The bar's middle line is in a box about a shape of the handle.

    Raises:
        InputError: It is not.
    """
    ends = np.array(bar.centre) + bar.reach * np.outer((-1.0, 1.0), bar.along)
    for at, half in boxes:
        seen = (ends - at.translation.middle) @ at.rotation.middle
        if (np.abs(seen) <= half + BESIDE).all():
            return
    raise InputError("grasps of a bar that is not the handle's", allowed="one inside a box about its shapes")


def refuted_grasps(grasps: Grasps, nodes: Iterator[int], box: tuple[Array, Array]) -> int:
    """Number of leaves of all trees, each of which is refuted; the cells are all grasps of the set.

    Args:
        grasps: Of one gripper at one value.
        nodes: Of the trees of cells, and of those in them.
        box: Lower and upper ends of the joints' positions, shape (n,).

    Raises:
        InputError: One is not, or the cells are not all grasps.
    """
    count = 0
    for sign in SIGNS:
        for low, high, node in cells_of(nodes, grasps.low, grasps.high):
            if node == LEAF:
                count += refuted_boxes(grasps.goal(sign, low, high), nodes, *box)
            elif node == HAND:
                count += refuted_limb(grasps.hand(sign), nodes, low, high)
            else:
                raise InputError("the proof's tree is damaged", allowed="a whole tree over a set of grasps")
    return count
