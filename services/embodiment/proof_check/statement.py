r"""What a proof refutes, as geometry in intervals; derived here from the twin, never from the proof.

Certification accepts a hold only if, when the container begins to move, two fingers touch its handle
when moved by at most `contact`; if from then on the tool keeps its pose on the handle to within
`tool_position` and `tool_angle`; and if every joint keeps its limits to within `position`. At every
value that the container passes, some point of the handle therefore lies in the *grasp box*: the box
about all fingers in the tool's frame, over all positions of the finger joints, widened by

.. math:: contact + tool\_position + 2 \sin(tool\_angle / 2) \max |p|.

The handle is where the kitchen's joints have it, each within `start` and `position` of its place. A
fixed base stands within `start_position` and `start_angle` of its start pose. To refute that for one
value of the container, for each gripper and all joint positions, is to refute every certificate of a
motion that takes the container past that value.

Of holds *in hand* less is to be refuted: when the handle is grasped, the tool's origin is at most `within`
from a box about it, later by `tool\_position` more. Nothing is then asked of the fingers.

In a box of joint positions that is shown by a joint's origin, farther from the handle than any point
of the grasp box can be from it; by the grasp box itself, apart from the handle in all of the box; or,
with a fixed base, by a box inside one of the arm's bodies that meets something solid (`cores`). No other
collision geometry is used.
"""

from copy import copy
from dataclasses import replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from sdt_kg.annotation import Drive, Gripper
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, joint_iri, local_name
from sdt_kg.motion import BASE_JOINTS
from sdt_kg.state import State
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import ROUNDING, Arm, Beside, beside, chain_to, make_arm, upright
from services.embodiment.proof_check.geometry.interval import exact
from services.embodiment.proof_check.geometry.mechanics import HERE, Chain, Link, Placement, Tree, base_T_root
from services.embodiment.proof_check.geometry.shapes import SOLVED, boxes_of, finger_box, tool_in, widened
from services.embodiment.proof_check.inside.boxes import Core, boxes_in, cores_on
from services.embodiment.proof_check.inside.solids import (
    WORLD,
    Around,
    Solids,
    Surroundings,
    kept_apart,
    own_solids,
)
from services.embodiment.proof_check.parked import with_parked
from services.embodiment.proof_check.passing import Passing
from services.embodiment.proof_check.pinch.between import Along, about_all, slab
from services.embodiment.proof_check.pinch.fingers import Hand, hand_of
from services.embodiment.proof_check.proof.claim import Bar
from services.embodiment.proof_check.target import Target, placed

Array = NDArray[np.float64]
Boxes = list[tuple[Placement, Array]]


class Statement:
    """What is to be refuted, for one robot, container, base policy and set of tolerances.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        start: Base pose x, y [m], yaw [rad] of a fixed base; not looked at otherwise.
        room: How far from `start` the fixed base may stand [m, m, rad]; a map asks for more than a pose.
        within: Of the holds that are meant, see `Claim`.
        declared: How the robot's bodies are taken, see `Claim`.
        span: Values that the container has to pass [rad or m]; None: those are not known.
        bar: Of which grasps alone are meant where a refutation is of these, see `Claim`.
    """

    def __init__(  # noqa: PLR0913, PLR0917  # what a claim is about
        self,
        twin: Twin,
        robot: Iri,
        container: Container,
        drive: Drive,
        start: tuple[float, float, float],
        tolerances: Tolerances,
        room: tuple[float, float, float] = (0.0, 0.0, 0.0),
        within: float | None = None,
        declared: bool = False,
        span: tuple[float, float] | None = None,
        bar: Bar | None = None,
    ) -> None:
        self.twin, self.robot, self.container, self.room = twin, robot, container, room
        self.span, self.passing = span, Passing.of(twin, container, span, tolerances)
        self.within, self.declared, self.bar = within, declared, bar
        self.level, self.start, self.tolerances = drive is not Drive.FIXED, start, tolerances
        self._annotation = twin.robot(robot)
        self.grippers = self._annotation.grippers
        self._tree = Tree(twin.mechanism(robot))
        self._kitchen = Tree(twin.mechanism(twin.environment))
        self._amid: tuple[bool, Along | None] | None = None
        self._chains: dict[tuple[object, ...], tuple[Chain, Array] | None] = {}
        self._targets: dict[tuple[float, float, bool], Target] = {}
        self._surroundings = Surroundings(self._kitchen)
        self._solids: dict[tuple[float, float], Solids] = {}
        self._boxes = cache(partial(boxes_in, self._tree, self._annotation, declared))
        self._cores: dict[str, tuple[Core, ...]] = {}
        self._own: dict[tuple[str, ...], tuple[Around, ...]] = {}
        self._limbs: dict[tuple[str, bool], Arm] = {}

    def standing(self, start: tuple[float, float, float], room: tuple[float, float, float]) -> "Statement":
        """The same, with the fixed base elsewhere."""
        about = self.twin, self.robot, self.container, Drive.FIXED, start, self.tolerances, room
        other = Statement(*about, self.within, self.declared, self.span, self.bar)
        other._chains, other._targets = self._chains, self._targets
        other._surroundings, other._solids, other._cores = self._surroundings, self._solids, self._cores
        return other

    def between(self, begins: bool, along: Along | None = None) -> "Statement":
        """The same of a point of a box about the handle that is between two fingers, see `pinch/`.

        Args:
            begins: Whether it is about the value at which the container begins to move: nothing slipped yet.
            along: Which holds are meant, by where along the fingers they have the handle; None: all.

        Raises:
            InputError: Holds in hand are meant.
        """
        if self.within is not None:
            raise InputError("a handle between two fingers, of holds in hand", allowed="of every hold")
        other = copy(self)
        other._amid = begins, along
        return other

    def arm(self, gripper: Gripper) -> Arm | None:
        """The chain of one gripper; None where its fingers have no box or a slide has no limits."""
        key = gripper.name, self._amid
        if key not in self._chains:
            self._chains[key] = self._behind_base(gripper)
        found = self._chains[key]
        if found is None:
            return None
        chain, corners = found
        if not self.level:
            whole = self._on_base(chain)
            if gripper.name not in self._cores:
                self._cores[gripper.name] = self._inside(chain)
            return replace(make_arm(gripper.name, whole, corners, 0), cores=self._cores[gripper.name])
        link, *others = chain.links
        whole = Chain((replace(link, before=self._height() @ link.before), *others), chain.end)
        return make_arm(gripper.name, whole, corners, upright(whole))

    def _height(self) -> Placement:
        """Where the base's frame is above the floor."""
        return Placement(HERE.rotation, exact([0.0, 0.0, self._annotation.base_height]))

    def _inside(self, chain: Chain) -> tuple[Core, ...]:
        """Boxes inside the bodies that a chain behind the base carries."""
        joints, root = [link.name for link in chain.links], base_T_root(self._tree, self._annotation)
        return cores_on(self._tree, self._boxes(), joints, root, len(BASE_JOINTS) - 1)

    def hand(self, gripper: Gripper) -> Hand | None:
        """The same with its fingers, for a base that is anywhere; None where it has no two to hold with."""
        arm = self.arm(gripper) if self.level else None
        return None if arm is None else hand_of(self._tree, gripper, arm, self.tolerances)

    def near(self, hand: Hand, value: float) -> float:
        """How far both fingers of a hand that holds the handle may be from it at a value [m]."""
        return hand.near(self.tolerances, begins=value == self.twin.state[self.container.joint])

    def _behind_base(self, gripper: Gripper) -> tuple[Chain, Array] | None:
        """The chain from the base's frame to the tool, and the corners of the grasp box."""
        corners = self._corners(gripper)
        if corners is None:
            return None
        joints = self._tree.path(self._tree.carrier(gripper.tool_body))
        first = base_T_root(self._tree, self._annotation)
        chain = self._tree.chain(joints, first, self.tolerances.position)
        whole = Chain(chain.links, chain.end @ tool_in(self._tree, gripper))
        bounded = all(np.isfinite((link.lower, link.upper)).all() for link in whole.links)
        return (whole, corners) if bounded and whole.links else None

    def around(self, arm: Arm, value: float, wide: float = 0.0) -> tuple[Around, ...]:
        """What is solid with the container so near to a value; nothing for an arm without cores."""
        if not arm.cores:
            return ()
        if (value, wide) not in self._solids:
            state = self.twin.at({self.container.joint: value}).state
            slack = partial(self.passing.slacks, value, self.tolerances.coupling, wide=wide)
            self._solids[value, wide] = self._surroundings.at(state, slack)
        solids = self._solids[value, wide]
        keeps = kept_apart(arm.cores, solids, self._tree, self._annotation)
        kitchen = Around(WORLD, solids, keeps)
        if any(self.room):  # a map asks at many poses: what does not depend on them is left out
            return (kitchen,)
        joints = tuple(link.name for link in arm.chain.links)
        if joints not in self._own:
            self._own[joints] = own_solids(arm.cores, self._tree, self._annotation)
        return kitchen, *self._own[joints]

    def beside(self, arm: Arm, body: str, value: float, parked: bool = False, wide: float = 0.0) -> Beside:
        """The joints that carry a body, beside an arm, with the container so near to a value.

        Where they are `parked`, those that no certified motion moves are.

        Raises:
            InputError: They have no limits of their own, or the base is free.
        """
        key = body, parked
        limb = self._limbs[key] = self._limbs.get(key) or self._limb(body, parked)
        return beside(arm, limb, self.around(limb, value, wide))

    def _limb(self, body: str, parked: bool) -> Arm:
        """The chain from a fixed base to a body, as an arm of no gripper."""
        if self.level:
            raise InputError(f"a proof from {body} with a free base", allowed="a fixed base")
        tree, annotation = self._tree, self._annotation
        chain = chain_to(tree, body, base_T_root(tree, annotation), self.tolerances)
        chain = with_parked(chain, tree.mechanism, annotation, self.tolerances) if parked else chain
        return replace(make_arm(body, self._on_base(chain), np.zeros((8, 3)), 0), cores=self._inside(chain))

    def _on_base(self, chain: Chain) -> Chain:
        """A chain behind a base that stands."""
        kept = self.tolerances
        slack, turn = kept.start_position + kept.position, kept.start_angle + kept.position
        slacks = tuple(one + more for one, more in zip((slack, slack, turn), self.room, strict=True))
        places = (self._height(), HERE, HERE)
        base = (
            Link(name, place, np.eye(3)[k], k == 2, self.start[k] - slacks[k], self.start[k] + slacks[k])
            for k, (name, place) in enumerate(zip(BASE_JOINTS, places, strict=True))
        )
        return Chain((*base, *chain.links), chain.end)

    def _corners(self, gripper: Gripper) -> Array | None:
        """Corners of the grasp box in the tool's frame [m], shape (8, 3); for holds in hand its origin."""
        if self.within is not None:
            return np.zeros((8, 3))
        kept = self.tolerances
        box, near, begins = finger_box(self._tree.mechanism, gripper, kept), kept.contact + ROUNDING, False
        if self._amid is not None:
            begins, along = self._amid
            box, near = slab(self._tree, gripper, kept, along), SOLVED
        return None if box is None else widened(box, near, kept, not begins)

    def handle_origin(self) -> Array:
        """Where the handle's frame is in the twin's state [m], shape (3,)."""
        chain = self._kitchen.chain(self._kitchen.path(self._handle), HERE, 0.0)
        _, _, end = chain.frames(self._positions(chain, self.twin.state))
        return end.translation.middle[0]

    def _positions(self, chain: Chain, state: State) -> Array:
        """Where joints of the kitchen are in a state [rad or m], shape (1, n)."""
        name = self._kitchen.mechanism.name
        return np.array([[state[joint_iri(name, link.name)] for link in chain.links]])

    def target(self, value: float, wide: float = 0.0) -> Target:
        """The handle with the container at a value, or up to `wide` beside it [rad or m].

        Raises:
            StateError: The value is outside the container's limits.
        """
        if (key := (value, wide, self._amid is None)) not in self._targets:
            self._targets[key] = self._placed(value, self.handle_boxes(), self.about, wide)
        return self._targets[key]

    def handle_boxes(self) -> Boxes:
        """Boxes about the handle's shapes in its frame, or one about all, and their half extents [m]."""
        boxes = [(box.middle, box.half) for box in boxes_of(self._kitchen, self._handle)]
        return boxes if self._amid is None or not boxes else [about_all(boxes)]

    @property
    def about(self) -> float:
        """How far from the handle holds have the grasp box at most [m]."""
        return 0.0 if self.within is None else self.within + self.tolerances.tool_position

    def cell(self, arm: Arm, value: float, low: Array, high: Array) -> Target:
        """Where the wrist is with the container at a value, if at the grasp it was in a cell.

        Args:
            arm: Whose last joint's origin it is.
            value: Of the container [rad or m].
            low: Of the cell, in the handle's frame [m], shape (3,).
            high: Of the cell.
        """
        far = float(arm.chain.end.translation.norm().hi)
        slip = self.tolerances.tool_position + 2 * float(np.sin(self.tolerances.tool_angle / 2)) * far
        half = np.maximum(high - (low + high) / 2, (low + high) / 2 - low) + slip + ROUNDING
        return self._placed(value, [(Placement(HERE.rotation, exact((low + high) / 2)), half)], 0.0)

    @property
    def _handle(self) -> str:
        return local_name(self.container.handle)

    def _placed(self, value: float, boxes: Boxes, about: float, wide: float = 0.0) -> Target:
        """Boxes of the handle's frame in the world, widened by what the kitchen's joints may be off."""
        chain, q, off = self.before_handle(value, wide)
        return placed(chain, q, boxes, off, about)

    def before_handle(self, value: float, wide: float = 0.0) -> tuple[Chain, Array, Array]:
        """The joints that carry the handle, where they are at a value, (1, n), and how far off, (n,)."""
        chain = self._kitchen.chain(self._kitchen.path(self._handle), HERE, 0.0)
        q = self._positions(chain, self.twin.at({self.container.joint: value}).state)
        return chain, q, self.passing.slacks(value, 0.0, chain.links, wide)
