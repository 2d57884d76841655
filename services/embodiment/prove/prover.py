"""Proofs that no certified motion takes a container past a value: found in floats, verified in intervals."""

from collections.abc import Callable
from copy import copy
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from predicates.case import Artefact, ArtefactKind
from sdt_kg.annotation import Drive, Gripper
from sdt_kg.errors import InputError
from sdt_kg.iri import Iri
from sdt_kg.motion import Motion
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.check import leaves_of_one, refuted
from services.embodiment.proof_check.haste import too_fast
from services.embodiment.proof_check.pinch.between import Along, places
from services.embodiment.proof_check.places import at_value
from services.embodiment.proof_check.proof.claim import Bar, Timing, claim_about
from services.embodiment.proof_check.proof.content import Proof, Refutation, at_one_value
from services.embodiment.proof_check.proof.written import to_bytes
from services.embodiment.proof_check.statement import Statement
from services.embodiment.prove.ends import by_ends
from services.embodiment.prove.grasps import of_grasps
from services.embodiment.prove.limbs.beside import Limbs, never
from services.embodiment.prove.pinch import by_fingers
from services.embodiment.prove.places import by_places
from services.embodiment.prove.proved import Proved
from services.embodiment.prove.said import diagnosis, too_slow
from services.embodiment.prove.tree.divided import divided
from services.embodiment.prove.values import Look, at_one, needed, spread
from services.embodiment.prove.windows import window

Array = NDArray[np.float64]

VALUES = 9  # of the container at which a proof is looked for
STANDING = 17  # the same, where the base stands: what an arm cannot get round may be there for a tenth of it
FEW = 3  # the same, where many base poses are asked about
MANY = 65  # the same, where something has to come inside what the base carries
SWEPT = 100  # boxes of such a proof
PARTS = 4  # of the way, at the ends of which one hold is refuted


class Prover:
    """Looks for proofs about one robot and container.

    Args:
        twin: Kitchen and robot, in the state in which the motion begins.
        start: Base pose x, y [m], yaw [rad] of a fixed base.
        values: Of the container's joint along τ; only what opens or closes it is taken for needed.
        within: Of the holds that are meant, see `Claim`; None: every one that certification accepts.
        declared: How the robot's bodies are taken, see `Claim`.
        bar: Of which grasps alone are meant, see `Claim`; None: every hold is.
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
        bar: Bar | None = None,
    ) -> None:
        self.twin, self.robot, self.container, self.drive = twin, robot, container, drive
        self.start = (float(start[0]), float(start[1]), float(start[2]))
        self.span = needed(container, twin.state[container.joint], values)
        about = twin, robot, container, drive, self.start, Tolerances()
        self.statement = Statement(*about, within=within, declared=declared, span=self.span, bar=bar)
        self.count = STANDING if drive is Drive.FIXED else VALUES
        self.parts = drive is Drive.FIXED  # whether fingers are parted where no tree of all is found
        self._arms: dict[tuple[str, bool | None, Along | None], tuple[Statement, Arm | None]] = {}
        self._trees: dict[tuple[str, float, int], Refutation | None] = {}
        self._pinched: dict[tuple[str, float], Refutation | None] = {}
        self._limbs: Limbs | None = None
        self._late: Callable[[], bool] = never

    def grasped(self, late: Callable[[], bool] = never) -> Proved | None:
        """A verified proof that no grasp of the bar can be had at one value, if one is found in time.

        Args:
            late: Whether time is up.
        """
        limbs = self._beside(late)
        found = limbs and self._checked(of_grasps(self.statement, self._values(), limbs, late))
        return self._told(*found) if found else None

    def standing(self, start: tuple[float, float, float], room: tuple[float, float, float]) -> "Prover":
        """The same, with the fixed base anywhere in a room about another pose; for `excludes`."""
        other = copy(self)
        other.count, other.parts = FEW, False
        other.start, other.statement, other._arms = start, self.statement.standing(start, room), {}
        other._trees = {}
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
        return None if found is None else self._told(*found)

    def _told(self, refutations: list[Refutation], leaves: int) -> Proved:
        """A verified proof."""
        assert self.span is not None
        about = self.twin, self.robot, self.container, self.span, self.drive, self.start
        of, once = self.statement, not at_one_value(refutations)
        claim = claim_about(*about, within=of.within, declared=of.declared, one_hold=once, bar=of.bar)
        artefact = Artefact(ArtefactKind.PROOF, to_bytes(Proof(claim, tuple(refutations))))
        return Proved(
            diagnosis(self.statement, refutations, leaves, whole=not claim.partial), artefact, leaves
        )

    def until(self, late: Callable[[], bool]) -> "Prover":
        """The same, of which trees are looked for until it is late; it knows those that were."""
        other = copy(self)
        other._late = late
        return other

    def swept(self, late: Callable[[], bool] = never) -> Proved | None:
        """The same where the container comes into what the base carries: at many values, until it is late."""
        other = self.until(late)
        other.count, other.parts = MANY, False
        other._limbs = self._beside(late)
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
        return Proved(too_slow(self.statement, found, motion), artefact, 0)

    def excludes(self, nodes: int) -> bool:
        """Whether no base pose in the room will do, proved with so many boxes for each gripper and value."""
        return self._verified(nodes) is not None

    def _verified(
        self, nodes: int, one_hold: bool = False, late: Callable[[], bool] = never
    ) -> tuple[list[Refutation], int] | None:
        """One refutation for each gripper, verified, and how many boxes were refuted in all."""
        if self.span is None:
            return None
        found = self._at_one_value(nodes)
        if found is None and one_hold:
            found = self._of_one_hold(nodes, late)
        return self._checked(found)

    def _checked(self, found: list[Refutation] | None) -> tuple[list[Refutation], int] | None:
        """The same, if the check finds so too."""
        if found is None or self.span is None:
            return None
        reasons, leaves = refuted(self.statement, self.span, tuple(found))
        return None if reasons else (found, leaves)

    def _at_one_value(self, nodes: int) -> list[Refutation] | None:
        """One refutation for each gripper, all at one value: none has the handle there, nor can take over."""
        by_tree = partial(self._at, nodes=nodes)
        found = at_one(self.statement.grippers, self._values(), by_tree)
        found = found or self._with_limbs(by_tree)
        return found or self._with_fingers(by_tree)

    def _of_one_hold(self, nodes: int, late: Callable[[], bool]) -> list[Refutation] | None:
        """The same, each at values of its own: one hold is one gripper's."""
        found: list[Refutation] = []
        for gripper in self.statement.grippers:
            each = (self._at(gripper, value, nodes) for value in self._values())
            one = next((one for one in each if one is not None), None) or self._by_places(gripper, late)
            if one is None:
                return None
            found.append(one)
        return found

    def _at(self, gripper: Gripper, value: float, nodes: int) -> Refutation | None:
        """The refutation of one gripper at a value by a tree of its arm's joints; looked for once."""
        key = gripper.name, value, nodes
        if key not in self._trees:
            if self._late():
                return None
            self._trees[key] = self._tree(*key[1:], gripper)
        return self._trees[key]

    def _tree(self, value: float, nodes: int, gripper: Gripper) -> Refutation | None:
        between, statement, arm = self._meant(gripper, value)
        if arm is None or not self.statement.handle_boxes():
            return None
        low, high = arm.chain.ranges()
        names = tuple(link.name for link in arm.chain.links)
        about = gripper.name, value, names, tuple(zip(low.tolist(), high.tolist(), strict=True))
        tree = divided(at_value(statement, arm, value), low, high, nodes)
        if tree is not None:
            return Refutation(*about, tree, between=between)
        if not between or not self.parts:
            return None
        parted = places(self.twin.mechanism(self.robot), gripper, self.statement.tolerances)
        found = by_ends(parted, partial(self._along, gripper, value, nodes))
        return None if found is None else Refutation(*about, found[1], between=True, ends=found[0])

    def _along(self, gripper: Gripper, value: float, nodes: int, along: Along) -> bytes | None:
        """A tree of the holds that have the handle along the fingers so."""
        statement, arm = self._of(gripper, value == self.twin.state[self.container.joint], along)
        return None if arm is None else divided(at_value(statement, arm, value), *arm.chain.ranges(), nodes)

    def _meant(self, gripper: Gripper, value: float | None) -> tuple[bool, Statement, Arm | None]:
        """The handle between two fingers, at a value or at all; in the grasp box where there are no two."""
        if self.statement.within is None:
            amid, arm = self._of(gripper, value == self.twin.state[self.container.joint])
            if arm is not None:
                return True, amid, arm
        return False, *self._of(gripper, None)

    def _of(
        self, gripper: Gripper, begins: bool | None, along: Along | None = None
    ) -> tuple[Statement, Arm | None]:
        """The gripper's arm in the statement about two fingers as the container begins, or after; or none."""
        key = gripper.name, begins, along
        if key not in self._arms:
            statement = self.statement if begins is None else self.statement.between(begins, along)
            self._arms[key] = statement, statement.arm(gripper)
        return self._arms[key]

    def _by_places(self, gripper: Gripper, late: Callable[[], bool]) -> Refutation | None:
        """A refutation of one hold of one gripper, at several values."""
        between, statement, arm = self._meant(gripper, None)
        if arm is None:
            return None
        values = sorted(self._values())[:: max((self.count - 1) // PARTS, 1)]
        found = by_places(statement, arm, values, late)
        return found if found is None else replace(found, between=between)

    def _with_limbs(self, by_tree: Look) -> list[Refutation] | None:
        """Refutations by bodies beside the arms, where such are looked for."""
        arms = {one.name: self._of(one, None)[1] for one in self.statement.grippers}
        limbs, known = self._limbs, {name: arm for name, arm in arms.items() if arm is not None}
        if limbs is None or not known or known.keys() != arms.keys():
            return None
        if self._late() or not self.statement.handle_boxes():
            return None

        return limbs.refutations(self.statement.grippers, known, by_tree, self._shown)

    def _shown(self, arm: Arm, one: Refutation) -> bool:
        """Whether the check finds so too: where a limb is grazed it may not."""
        try:
            return leaves_of_one(self.statement, arm, one) > 0
        except InputError:
            return False

    def _with_fingers(self, by_tree: Look) -> list[Refutation] | None:
        """Refutations of two fingers of grippers together, at an end of the span."""
        if not self.statement.level or self.statement.within is not None:
            return None

        def look(gripper: Gripper, value: float) -> Refutation | None:
            return by_tree(gripper, value) or self._by_fingers(gripper, value)

        return at_one(self.statement.grippers, self._values()[:2], look)

    def _by_fingers(self, gripper: Gripper, value: float) -> Refutation | None:
        """A refutation of two fingers of one gripper together, at a value; looked for once."""
        key = gripper.name, value
        if key not in self._pinched:
            hand = self.statement.hand(gripper)
            self._pinched[key] = None if hand is None else by_fingers(self.statement, hand, value)
        return self._pinched[key]

    def _beside(self, late: Callable[[], bool]) -> Limbs | None:
        """Who looks for limbs that are in the way, at many values; none where the container need not move."""
        return None if self.span is None else Limbs(self.statement, self._spread(MANY), late)

    def _values(self) -> list[float]:
        values = self._spread(self.count)
        return sorted(values, key=lambda value: -abs(value - (values[0] + values[-1]) / 2))

    def _spread(self, count: int) -> list[float]:
        assert self.span is not None
        return spread(self.span, self.twin.state[self.container.joint], count)
