"""Proofs that no certified motion takes a container past a value: found in floats, verified in intervals."""

from collections.abc import Callable, Iterator
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from predicates.case import Artefact, ArtefactKind, Diagnosis, Evidence, Kind, Quantity
from sdt_kg.annotation import Drive, Gripper
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri, local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.check import leaves_of_one, refuted
from services.embodiment.proof_check.claim import Timing, claim_about
from services.embodiment.proof_check.content import Proof, Refutation
from services.embodiment.proof_check.haste import too_fast
from services.embodiment.proof_check.mechanics import Tree
from services.embodiment.proof_check.parked import stands
from services.embodiment.proof_check.places import at_value
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.written import to_bytes
from services.embodiment.prove.boxes import LEAF
from services.embodiment.prove.divided import divided
from services.embodiment.prove.limbs.beside import Limbs, never
from services.embodiment.prove.pinch import by_fingers
from services.embodiment.prove.places import by_places
from services.embodiment.prove.values import needed, spread
from services.embodiment.prove.windows import window

Array = NDArray[np.float64]

VALUES = 9  # of the container at which a proof is looked for
FEW = 3  # the same, where many base poses are asked about
MANY = 65  # the same, where something has to come inside what the base carries
SWEPT = 100  # boxes of such a proof
AMID = 2_000  # the same, of an arm where limbs beside it are in the way in some parts of the lift only
SPARSE = 2  # every so many of them, where one hold at several is refuted
HINGE, SLIDE = "rad", "m"


@dataclass(frozen=True, slots=True)
class Proved:
    """A verified proof.

    Attributes:
        boxes: Of joint positions that were refuted one by one.
    """

    diagnosis: Diagnosis
    artefact: Artefact
    boxes: int


class Prover:
    """Looks for proofs about one robot and container.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        start: Base pose x, y [m], yaw [rad] of a fixed base.
        values: Of the container's joint along τ; only what opens or closes it is taken for needed.
        within: Of the holds that are meant, see `Claim`; None: every one that certification accepts.
        declared: How the robot's bodies are taken, see `Claim`.
    """

    def __init__(  # noqa: PLR0913, PLR0917  # what a claim is about
        self,
        twin: Twin,
        robot: Iri,
        container: Container,
        drive: Drive,
        start: tuple[float, float, float],
        values: Array,
        within: float | None = None,
        declared: bool = False,
    ) -> None:
        self.twin, self.robot, self.container, self.drive = twin, robot, container, drive
        self.start = (float(start[0]), float(start[1]), float(start[2]))
        self.span = needed(container, twin.state[container.joint], values)
        about = twin, robot, container, drive, self.start, Tolerances()
        self.statement = Statement(*about, within=within, declared=declared, span=self.span)
        self.count = VALUES
        self._arms: dict[tuple[str, bool | None], tuple[Statement, Arm | None]] = {}
        self._pinched: dict[str, Refutation | None] = {}
        self._limbs: Limbs | None = None
        self._late: Callable[[], bool] = never

    def standing(self, start: tuple[float, float, float], room: tuple[float, float, float]) -> "Prover":
        """The same, with the fixed base anywhere in a room about another pose; for `excludes`."""
        other = copy(self)
        other.count = FEW
        other.start, other.statement, other._arms = start, self.statement.standing(start, room), {}
        return other

    def prove(self, nodes: int, one_hold: bool = False, late: Callable[[], bool] = never) -> Proved | None:
        """A verified proof, if one is found with at most so many boxes for each gripper and value.

        Args:
            nodes: Boxes.
            one_hold: Whether one hold at all values is refuted where no single value refutes all holds.
            late: Whether time is up for that: half a minute for a gripper, if none is found.
        """
        assert self.statement.room == (0.0, 0.0, 0.0), "a claim is about one base pose"
        found = self._verified(nodes, one_hold, late)
        if found is None or self.span is None:
            return None
        refutations, leaves = found
        about = self.twin, self.robot, self.container, self.span, self.drive, self.start
        of, once = self.statement, any(one.one_hold for one in refutations)
        claim = claim_about(*about, within=of.within, declared=of.declared, one_hold=once)
        artefact = Artefact(ArtefactKind.PROOF, to_bytes(Proof(claim, tuple(refutations))))
        return Proved(self._diagnosis(refutations, leaves, whole=not claim.partial), artefact, leaves)

    def swept(self, late: Callable[[], bool] = never) -> Proved | None:
        """The same where the container comes into what the base carries: at many values, until it is late."""
        other = copy(self)
        other.count, other._late = MANY, late
        if self.span is not None:
            other._limbs = Limbs(self.statement, sorted(other._values()), late)
        return other.prove(SWEPT)

    def hurried(self, motion: Motion) -> Proved | None:
        """A verified proof that no gripper is as fast as a timed motion of the container asks."""
        if self.span is None or not motion.timed or motion.is_poses:
            return None
        times, values = motion.times, motion.values[:, 0]
        found = window(self.statement, self.drive, times, values)
        if found is None:
            return None
        timing = Timing(tuple(times.tolist()), tuple(values.tolist()))
        if [*too_fast(self.statement, self.drive, timing, found.ends)]:
            return None
        about = self.twin, self.robot, self.container, self.span, self.drive, self.start, timing
        artefact = Artefact(ArtefactKind.PROOF, to_bytes(Proof(claim_about(*about), (), found.ends)))
        first, last = (float(times[k]) for k in found.ends)
        robot, handle = local_name(self.robot), local_name(self.container.handle)
        reason = (
            f"{handle} has to move at {found.asked:.2f} m/s between {first:.2f} s and {last:.2f} s of the "
            f"motion; no gripper of {robot} holds it at more than {found.most:.2f} m/s, in whatever posture"
        )
        asked = Evidence(
            Quantity.VELOCITY, found.asked, found.most, "m/s", entity=self.container.handle, time=first
        )
        return Proved(Diagnosis(Kind.EMBODIMENT, reason, asked, proof=True), artefact, 0)

    def excludes(self, nodes: int) -> bool:
        """Whether no base pose in the room will do, proved with so many boxes for each gripper and value."""
        return self._verified(nodes) is not None

    def _verified(
        self, nodes: int, one_hold: bool = False, late: Callable[[], bool] = never
    ) -> tuple[list[Refutation], int] | None:
        """One refutation for each gripper, verified, and how many boxes were refuted in all."""
        if self.span is None:
            return None
        refutations: list[Refutation] = []
        for gripper in self.statement.grippers:
            found = next(self._refutations(gripper, nodes), None) or self._by_limbs(gripper)
            if found is None and self.statement.within is None:
                found = self._by_fingers(gripper)
            if found is None and one_hold:
                found = self._by_places(gripper, late)
            if found is None:
                return None
            refutations.append(found)
        reasons, leaves = refuted(self.statement, self.span, tuple(refutations))
        return None if reasons else (refutations, leaves)

    def _refutations(self, gripper: Gripper, nodes: int) -> Iterator[Refutation]:
        """Refutations of one gripper, at values from the ends of the span inwards."""
        if not self.statement.handle_boxes():
            return
        for value in self._values():
            between, statement, arm = self._meant(gripper, value)
            if arm is None or self._late():
                return
            low, high = arm.chain.ranges()
            tree = divided(at_value(statement, arm, value), low, high, nodes)
            if tree is not None:
                names = tuple(link.name for link in arm.chain.links)
                box = tuple(zip(low.tolist(), high.tolist(), strict=True))
                yield Refutation(gripper.name, value, names, box, tree, between=between)

    def _meant(self, gripper: Gripper, value: float | None) -> tuple[bool, Statement, Arm | None]:
        """The handle between two fingers, at a value or at all; in the grasp box where there are no two."""
        if self.statement.within is None:
            amid, arm = self._of(gripper, value == self.twin.state[self.container.joint])
            if arm is not None:
                return True, amid, arm
        return False, *self._of(gripper, None)

    def _of(self, gripper: Gripper, begins: bool | None) -> tuple[Statement, Arm | None]:
        """The gripper's arm in the statement about two fingers as the container begins, or after; or none."""
        key = gripper.name, begins
        if key not in self._arms:
            statement = self.statement if begins is None else self.statement.between(begins)
            self._arms[key] = statement, statement.arm(gripper)
        return self._arms[key]

    def _by_places(self, gripper: Gripper, late: Callable[[], bool]) -> Refutation | None:
        """A refutation of one hold of one gripper, at several values."""
        between, statement, arm = self._meant(gripper, None)
        if arm is None:
            return None
        found = by_places(statement, arm, sorted(self._values())[::SPARSE], late)
        return found if found is None else replace(found, between=between)

    def _by_limbs(self, gripper: Gripper) -> Refutation | None:
        """A refutation of one gripper by bodies beside its arm, where such are looked for."""
        if self._limbs is None or self._late() or not self.statement.handle_boxes():
            return None
        _, arm = self._of(gripper, None)
        if arm is None:
            return None
        found = self._limbs.refutations(arm, AMID)
        return next((one for one in found if self._shown(arm, one)), None)

    def _shown(self, arm: Arm, one: Refutation) -> bool:
        """Whether the check finds so too: where a limb is grazed it may not."""
        try:
            return leaves_of_one(self.statement, arm, one) > 0
        except InputError:
            return False

    def _by_fingers(self, gripper: Gripper) -> Refutation | None:
        """A refutation of two fingers of one gripper together, at an end of the span; looked for once."""
        if gripper.name not in self._pinched:
            hand = self.statement.hand(gripper) if self.statement.level else None
            values = [] if hand is None else self._values()[:2]
            found = (by_fingers(self.statement, hand, value) for value in values if hand is not None)
            self._pinched[gripper.name] = next((one for one in found if one is not None), None)
        return self._pinched[gripper.name]

    def _values(self) -> list[float]:
        assert self.span is not None
        values = spread(self.span, self.twin.state[self.container.joint], self.count)
        return sorted(values, key=lambda value: -abs(value - (values[0] + values[-1]) / 2))

    def _diagnosis(self, refutations: list[Refutation], leaves: int, *, whole: bool) -> Diagnosis:
        """In words: where the handle is out of reach, and for which base."""
        assert self.span is not None
        value = refutations[0].value
        joint = self.twin.mechanism(self.twin.environment).joint(local_name(self.container.joint))
        unit = SLIDE if joint.type is JointType.PRISMATIC else HINGE
        boxes = self.statement.target(value).boxes
        height = np.array([(box.translation.lo[2] + box.translation.hi[2]) / 2 for box in boxes])
        handle = local_name(self.container.handle)
        where = (
            f"at a height of {height.mean():.3f} m, whatever base pose it takes"
            if self.statement.level
            else "with its base fixed at {:.2f} m, {:.2f} m, {:.2f} rad".format(*self.start)
        )
        within = self.statement.within
        come = "come to" if within is None else f"have the middle between its fingers within {within:g} m of"
        if any(one.pinched or one.between for one in refutations):
            come = "bring two fingers to"
        values = sorted({value for one in refutations for value in one.values})
        if any(one.places is not None for one in refutations):
            amid = "one hold" if within is None else f"the middle between its fingers within {within:g} m"
            come, value = f"keep {amid} of", values[-1]
        there = " and ".join(f"{each:.3g}" for each in values)
        reason = (
            f"no gripper of {local_name(self.robot)} can {come} {handle} with {self.container.name} at "
            f"{there} {unit}, {where}: all joint positions are refuted, in {leaves} box(es)"
        )
        if inside := self._inside(refutations):
            reason += f"; in some of them {inside} would be inside the furniture or the robot"
        if any(one.steps is not None for one in refutations):
            reason += (
                "; each part of the lift at one of these values, and from one to the next where they meet"
            )
        if held := self._held(refutations):
            reason += f", with {held} where the robot is parked, since no limit of acceleration is known"
        opens = self.twin.state[self.container.joint] <= self.span[0]
        demanded = self.span[1] if opens else self.span[0]
        evidence = Evidence(Quantity.POSITION, demanded, value, unit, entity=self.container.joint)
        if self.statement.declared:
            reason += "; its bodies are taken as the collision shapes that certification has"
        return Diagnosis(Kind.EMBODIMENT, reason, evidence, proof=whole)

    def _held(self, refutations: list[Refutation]) -> str:
        """Names of joints behind limbs beside the arm that no certified motion moves."""
        tree, own = Tree(self.twin.mechanism(self.robot)), self.twin.robot(self.robot)
        limbs = {body for one in refutations if one.parked for body in one.beside}
        joints = {joint for body in limbs for joint in tree.path(body) if joint.type is not JointType.FIXED}
        return ", ".join(sorted(joint.name for joint in joints if stands(joint, own)))

    def _inside(self, refutations: list[Refutation]) -> str:
        """Names of the bodies whose cores refute something at a single value; of limbs, the ends."""
        bodies: set[str] = set()
        for one in refutations:
            if one.beside:
                bodies.update(f"{body} or what carries it" for body in one.beside)
                continue
            arm = next(arm for key, (_, arm) in self._arms.items() if key[0] == one.gripper and arm)
            first = LEAF + len(one.joints) + 1
            codes = set(one.tree) if one.places is None else set[int]()
            bodies.update(arm.cores[code - first].body for code in codes if code >= first)
        return ", ".join(sorted(bodies))
