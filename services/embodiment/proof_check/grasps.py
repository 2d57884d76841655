r"""Grasps of a set: how the hand is about a bar, as positions of joints from the bar to the tool.

A grasp set is data: the fingers close across a bar of the handle, and the hand comes from the front. With
the bar's direction b and o, away from the front, and with :math:`c = o \times b`, a grasp has the tool's
approach and closing direction, of either sign, along

.. math:: a = \cos\tau\,(\sin\varphi\, c - \cos\varphi\, o) + \sin\tau\, b,
          \qquad y = \pm(\cos\varphi\, c + \sin\varphi\, o),

and its origin at the bar's middle + s b + d a: `place` s, `pitch` :math:`\varphi`, `tilt` :math:`\tau` and
`depth` d, each between its ends. These are four joints of a chain from the bar to the tool, which the arm
closes (`loop.py`). Refuted are all motions that hold the bar in such a grasp, to within `tool_position` and
`tool_angle` once the container moves, as certification has it. Nothing else is asked of fingers and handle.

The trees of both signs come one after the other.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from services.embodiment.proof_check.arm import ROUNDING, Arm, Beside, make_arm
from services.embodiment.proof_check.bars import bar_of
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.levers import lever_of
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement
from services.embodiment.proof_check.inside.boxes import Core
from services.embodiment.proof_check.inside.solids import WORLD, Around
from services.embodiment.proof_check.loop import End, Loop, refuted_loop
from services.embodiment.proof_check.places import wrist_of
from services.embodiment.proof_check.proof.claim import DEPTH, PITCH, TILT, Bar
from services.embodiment.proof_check.statement import Statement

Array = NDArray[np.float64]

OFF = 1e-4  # [m, rad] a grasp may be off the set by, for rounding
COORDINATES = ("place", "pitch", "tilt", "depth")
"""Of a grasp: they come behind the arm's joints."""
SIGNS = (1.0, -1.0)
"""Of the closing direction."""


class Grasps:
    """All grasps of a bar by one gripper, with the container at one value.

    Args:
        statement: What is to be refuted.
        arm: The gripper's.
        bar: Of the handle.
        value: Of the container [rad or m].
        beside: Limbs beside the arm, with the container there.

    Raises:
        InputError: The base is free, or the handle has no such bar.
    """

    def __init__(
        self, statement: Statement, arm: Arm, bar: Bar, value: float, beside: tuple[Beside, ...] = ()
    ) -> None:
        if statement.level:
            raise InputError("a proof about a set of grasps, with a free base", allowed="a fixed base")
        kept, frame = statement.tolerances, bar_of(statement, bar)
        chain, q, off = statement.before_handle(value)
        origins, axes, joint = Chain(chain.links, HERE).frames(q)
        hinges = np.array([link.turns for link in chain.links])
        self._bar = Placement(joint.rotation[0], joint.translation[0]) @ frame
        last = arm.chain.end.inverse().translation  # the last joint's origin, seen from the tool
        far = float(np.linalg.norm(frame.translation.middle)) + bar.reach + DEPTH + float(last.norm().hi)
        levers = lever_of(origins, axes, joint.translation, chain.links) + np.where(hinges, far, 0.0)
        self._shift, self._turned = float((levers * off).sum()), float(off[hinges].sum())
        slips = value != statement.twin.state[statement.container.joint]
        self._slip, self._turn = (kept.tool_position, kept.tool_angle) if slips else (0.0, 0.0)
        self._high = np.array([bar.reach, PITCH, TILT, DEPTH])
        tool = replace(make_arm(arm.gripper, arm.chain, np.zeros((8, 3)), 0), cores=arm.cores)
        self._ends = self._end(tool, np.zeros(3)), self._end(wrist_of(arm), last.middle)
        self._around, self._beside = statement.around(arm, value), beside
        self._hand = self._of_hand(arm)

    def ranges(self) -> tuple[Array, Array]:
        """Lower and upper ends of all positions of the arm's joints, then of a grasp, shape (n + 4,)."""
        return self.loop(SIGNS[0]).ranges()

    def loop(self, sign: float) -> Loop:
        """What is to be refuted of grasps that close along y or against it."""
        bar, (seen, around) = self._to_tool(sign), self._hand
        cores = tuple(replace(core, middle=bar.end @ core.middle) for core in seen)
        alone = replace(make_arm("hand", bar, np.zeros((8, 3)), 0), cores=cores)
        hand = Beside(alone, around, len(COORDINATES))
        return Loop(self._ends, self._around, bar, hand, self._turn + OFF + self._turned, self._beside)

    def _end(self, arm: Arm, seen: Array) -> End:
        return End(arm, seen, self._off(float(np.linalg.norm(seen))))

    def _of_hand(self, arm: Arm) -> tuple[tuple[Core, ...], tuple[Around, ...]]:
        """Cores that the last joint carries, seen from the tool, less what it slips; and what they meet."""
        last, back = len(arm.chain.links) - 1, arm.chain.end.inverse()
        own = [k for k, core in enumerate(arm.cores) if core.link == last]
        found = list[Core]()
        for core in (arm.cores[k] for k in own):
            at = back @ core.middle
            less = self._off(float(at.translation.norm().hi + np.linalg.norm(core.half)))
            found.append(Core(core.body, len(COORDINATES) - 1, at, np.maximum(core.half - less, 0.0)))
        still = (replace(one, keeps=one.keeps[own]) for one in self._around if one.carrier == WORLD)
        return tuple(found), tuple(still)

    def _off(self, far: float) -> float:
        """How far a point so far from the tool's origin may be from where a grasp has it [m]."""
        return self._slip + OFF + far * (OFF + self._turn + self._turned) + self._shift + ROUNDING

    def _to_tool(self, sign: float) -> Chain:
        """The bar's place, pitch, tilt and depth as joints, from the world to the tool."""
        axes = np.array([[0.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])
        links = tuple(
            Link(name, HERE if k else self._bar, axes[k], name in {"pitch", "tilt"}, -most, most)
            for k, (name, most) in enumerate(zip(COORDINATES, self._high.tolist(), strict=True))
        )
        hand = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, sign], [0.0, sign, 0.0]])
        return Chain(links, Placement(exact(hand), exact(np.zeros(3))))


def refuted_grasps(grasps: Grasps, nodes: Iterator[int], low: Array, high: Array) -> int:
    """Number of leaves of both trees, each of which is refuted.

    Args:
        grasps: Of one gripper at one value.
        nodes: Of the trees.
        low: Of positions of the arm's joints and of the grasp, shape (n + 4,).
        high: Of the same.

    Raises:
        InputError: One is not, or a tree does not cover the box.
    """
    return sum(refuted_loop(grasps.loop(sign), nodes, low, high) for sign in SIGNS)
