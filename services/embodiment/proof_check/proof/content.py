"""A proof: what it claims, what it assumes, and one tree of boxes for each gripper."""

from collections.abc import Iterable
from dataclasses import dataclass

from sdt_kg.annotation import Drive
from services.embodiment.proof_check.proof.claim import Claim

IN_HAND = 0.02
"""[m] Ours: in hand is a handle whose box is so near to the tool's origin, amid the fingertips, at the grasp;
the search has it there to within 16 mm."""
LEAF = 128
NO_HOLD = 255

PINCHED = (
    "fingers: two of them are at the handle at once, so both come as high as it; those that one motor drives "
    "differ by no more than the twin says"
)
BETWEEN = "fingers: two of them are at the handle at once, so a point of a box about it is between them"
ENDS = (
    "along the fingers: both touch the handle beyond a place, or one of them before it; of either all holds "
    "are refuted"
)
BESIDE = "limbs beside the arm: they, too, are somewhere within their limits, and touch nothing"
PARKED = "limbs without a limit of acceleration: parked, since certification lets none of their joints move"
STEPPED = "lift: it moves without jumps while the container does, as certification demands"
ONE_HOLD = (
    "one hold: the tool keeps the pose on the handle that it has at the grasp, at all values; that the "
    "handle is let go on the way, and held anew, is not refuted"
)


@dataclass(frozen=True, slots=True)
class Places:
    """Of a tree of cells: what it divides.

    Attributes:
        values: Of the container's own joint, one of which refutes each cell [rad or m].
        box: Places of the wrist in the handle's frame, an interval along each axis [m].
    """

    values: tuple[float, ...]
    box: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Steps:
    """Of a lift that is divided in equal parts: at which values of the container each part is refuted.

    Attributes:
        values: Of the container's own joint, one for each part, from the lowest part on [rad or m].
        pieces: In how many the way is divided from each of these values to the next; 0 if it is the same.
    """

    values: tuple[float, ...]
    pieces: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Refutation:
    """Why one gripper cannot hold the handle with the container at a value, or all along.

    Attributes:
        value: Of the container's own joint [rad or m]; with `places`, that which refutes most cells, with
            `steps`, the first.
        joints: Names of the chain's joints, from the world on.
        box: Interval of each joint [rad or m].
        tree: Its division, see `written.py`.
        places: Where one hold at several values is refuted, and not all holds at one.
        pinched: Whether it is refuted that two fingers come to the handle together.
        beside: Bodies that other joints carry, to whose trees the tree may go over.
        between: Whether it is refuted that a point of a box about the handle is between two fingers.
        parked: Whether joints of those bodies that no certified motion moves are where they are parked.
        steps: Where parts of the lift are refuted at values of their own.
        grasped: Whether a set of grasps is refuted, and no other holds (`grasps.py`).
        ends: Where the fingers are parted, along x of the tool [m]; the tree is of what both have beyond it,
            then of what one has before.
    """

    gripper: str
    value: float
    joints: tuple[str, ...]
    box: tuple[tuple[float, float], ...]
    tree: bytes
    places: Places | None = None
    pinched: bool = False
    beside: tuple[str, ...] = ()
    between: bool = False
    parked: bool = False
    steps: Steps | None = None
    ends: float | None = None
    grasped: bool = False

    @property
    def values(self) -> tuple[float, ...]:
        """All values that are needed [rad or m]."""
        several = self.places or self.steps
        return (self.value,) if several is None else several.values

    @property
    def one_hold(self) -> bool:
        """Whether it refutes one hold at several values, and not every hold at one."""
        return self.places is not None and len(set(self.places.values)) > 1


def at_one_value(refutations: Iterable[Refutation]) -> bool:
    """Whether all are at one value, of every hold there: then no gripper takes over from another.

    Steps are of limbs that are in the way whoever holds the handle, if anyone does.
    """
    each = [*refutations]
    if any(one.one_hold for one in each):
        return False
    stepped = any(one.steps is not None for one in each)
    return stepped or len({value for one in each for value in one.values}) <= 1


@dataclass(frozen=True, slots=True)
class Proof:
    """A claim and what shows it.

    Attributes:
        window: First and last sample of the timing between which no gripper follows; None without one.
        others: The same by each other handle that moves the container.
        misstated: Whether what was read of it states other assumptions than its own.
    """

    claim: Claim
    refutations: tuple[Refutation, ...]
    window: tuple[int, int] | None = None
    others: "tuple[Proof, ...]" = ()
    misstated: bool = False

    def assumptions(self) -> tuple[str, ...]:
        """What the claim is relative to, one sentence each."""
        claim = self.claim
        base = "the base stands at {:.3f} m, {:.3f} m, {:.3f} rad".format(*claim.start)
        if claim.drive is not Drive.FIXED:
            base = "the base stands anywhere on the floor, at any angle"
        if claim.timing is not None:
            return (
                f"base policy: {claim.drive.value}, with its speed limits",
                f"tolerances: those of certification, {claim.tolerances}",
                "joints: velocity limits of the twin, each joint for itself, stretched out as far as it goes",
                "no collision geometry but that of the fingers and the handle, which a hold is about",
            )
        return (
            f"base policy: {claim.drive.value}, {base}",
            f"grasp set: {claim.holds}",
            f"tolerances: those of certification, {claim.tolerances}",
            *([ONE_HOLD] if claim.one_hold else []),
            *([BESIDE] if any(one.beside for one in self.refutations) else []),
            *([STEPPED] if any(one.steps is not None for one in self.refutations) else []),
            *([PARKED] if any(one.parked for one in self.refutations) else []),
            *([BETWEEN] if any(one.between for one in self.refutations) else []),
            *([ENDS] if any(one.ends is not None for one in self.refutations) else []),
            *([PINCHED] if any(one.pinched for one in self.refutations) else []),
            "joints: limits of the twin, each joint for itself",
            f"collision geometry: {claim.about}; besides, with a fixed base, boxes inside {claim.bodies}, "
            "inside the kitchen's boxes, cylinders and spheres as they are declared, and below the floor",
        )
