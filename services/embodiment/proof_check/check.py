"""Whether a proof of infeasibility holds, in interval arithmetic and without the code that found it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from predicates.meant import by_other_handles, handles_of_no_container
from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Container, Twin
from services.embodiment.proof_check.arm import Arm, Beside
from services.embodiment.proof_check.asked import differs
from services.embodiment.proof_check.grasps import COORDINATES, Grasps, refuted_grasps
from services.embodiment.proof_check.handles import another_question
from services.embodiment.proof_check.haste import too_fast
from services.embodiment.proof_check.pinch.between import Along
from services.embodiment.proof_check.pinch.fingers import handle_span
from services.embodiment.proof_check.pinch.refuted import refuted_pinches
from services.embodiment.proof_check.places import at_value, refuted_places
from services.embodiment.proof_check.proof.claim import Timing, other_handle
from services.embodiment.proof_check.proof.content import Proof, Refutation, at_one_value
from services.embodiment.proof_check.proof.written import read_proof
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.steps import refuted_steps
from services.embodiment.proof_check.tree import refuted_boxes

Array = NDArray[np.float64]

MOST_NODES = 2_000_000  # of one tree


@dataclass(frozen=True, slots=True)
class Checked:
    """What a check found.

    Attributes:
        reasons: Why the proof does not hold; empty if it does.
        statement: What it shows, one sentence.
        assumptions: What that is relative to.
        leaves: Boxes that were refuted.
    """

    reasons: tuple[str, ...]
    statement: str
    assumptions: tuple[str, ...]
    leaves: int

    @property
    def holds(self) -> bool:
        """Whether nothing speaks against it."""
        return not self.reasons


def check(twin: Twin, robot: Iri, container: Container, content: bytes) -> Checked:
    """Whether a proof shows, for this twin, that no certified motion opens or closes the container.

    Unless it is `partial`, by none of the handles that move it.

    Raises:
        InputError: The content is no proof, or damaged.
    """
    proof = read_proof(content)
    found = _by_handle(twin, robot, container, proof)
    if proof.claim.partial:
        return found
    given = {(one.claim.container, one.claim.handle): one for one in proof.others}
    for other in by_other_handles(twin, container):
        one = given.get((other.iri, other_handle(twin, other)))
        handle = local_name(other.handle)
        if one is None:
            reason = f"{handle} moves {container.name}, too, and of it nothing is proved"
            found = replace(found, reasons=(*found.reasons, reason))
            continue
        more, asked = _by_handle(twin, robot, other, one), another_question(twin, container, proof, one)
        found = Checked(
            (*found.reasons, *(f"of {handle}: {reason}" for reason in (*asked, *more.reasons))),
            f"{found.statement}; held by {handle}: {more.statement}",
            tuple(dict.fromkeys((*found.assumptions, *more.assumptions))),
            found.leaves + more.leaves,
        )
    unknown = map(local_name, handles_of_no_container(twin, container))
    moves = f"moves {container.name}, too, though it is no container's, and of it nothing is proved"
    return replace(found, reasons=(*found.reasons, *(f"{handle} {moves}" for handle in unknown)))


def _by_handle(twin: Twin, robot: Iri, container: Container, proof: Proof) -> Checked:
    """The same of the one handle that the container is meant by."""
    claim = proof.claim
    reasons = [*differs(twin, robot, container, claim)]
    if proof.misstated:
        reasons.append("the assumptions that the proof states are not those on which it rests")
    leaves = 0
    if not reasons:
        about = twin, robot, container, claim.drive, claim.start, claim.tolerances
        statement = Statement(
            *about, within=claim.within, declared=claim.declared, span=claim.span, bar=claim.bar
        )
        if claim.timing is not None:
            reasons += _hurried(statement, proof, claim.timing)
        else:
            found, leaves = refuted(statement, claim.span, proof.refutations)
            reasons += found
            if not at_one_value(proof.refutations) and not claim.one_hold:
                reasons.append(
                    "not every gripper is refuted at one value, and the proof is about several holds"
                )
    if claim.timing is not None:
        sentence = f"no certified motion of {local_name(robot)} moves {container.name} in the given times"
        return Checked(tuple(reasons), sentence, proof.assumptions(), leaves)
    values = sorted({value for one in proof.refutations for value in one.values})
    past = ", ".join(f"{value:.4g}" for value in values) or "any value"
    meant = "" if claim.within is None else f"with {local_name(container.handle)} in hand "
    meant += f"in a grasp across the bar of {local_name(container.handle)} " if claim.bar else ""
    meant += "(its collision shapes for its bodies) " if claim.declared else ""
    meant += "in one hold " if claim.one_hold else ""
    sentence = f"no certified motion of {local_name(robot)} {meant}takes {container.name} past {past}"
    return Checked(tuple(reasons), sentence, proof.assumptions(), leaves)


def _hurried(statement: Statement, proof: Proof, timing: Timing) -> list[str]:
    """Why the times are not shown to be too short."""
    if proof.window is None or proof.refutations:
        return ["the proof is about times and has no window of samples, or more than that"]
    try:
        return [*too_fast(statement, proof.claim.drive, timing, proof.window)]
    except SdtError as error:
        return [str(error)]


def refuted(
    statement: Statement, span: tuple[float, float], refutations: tuple[Refutation, ...]
) -> tuple[list[str], int]:
    """Why the refutations do not cover every gripper, and how many boxes were refuted."""
    reasons: list[str] = []
    given = {one.gripper: one for one in refutations}
    leaves = 0
    if len(given) < len(refutations) or not given.keys() <= {one.name for one in statement.grippers}:
        reasons.append("a refutation is of no gripper, or of one that another is of")
    for gripper in statement.grippers:
        one, arm = given.get(gripper.name), statement.arm(gripper)
        if one is None:
            reasons.append(f"gripper {gripper.name} is not refuted")
        elif arm is None:
            reasons.append(f"gripper {gripper.name} has no fingers with shapes that move with its tool")
        elif beyond := [value for value in one.values if not span[0] <= value <= span[1]]:
            reasons.append(f"the container need not pass {beyond[0]:.4g}, at which {gripper.name} is refuted")
        else:
            try:
                leaves += leaves_of_one(statement, arm, one)
            except SdtError as error:
                reasons.append(f"gripper {gripper.name}: {error}")
    if not statement.grippers:
        reasons.append("the robot has no gripper: nothing to refute")
    return reasons, leaves


def leaves_of_one(statement: Statement, arm: Arm, given: Refutation) -> int:
    """Number of leaves of one refutation's tree, each of which is refuted.

    Raises:
        InputError: One is not, or the tree does not cover all joint positions.
    """
    if len(given.tree) > MOST_NODES:
        raise InputError(f"a tree of {len(given.tree)} nodes", allowed=f"at most {MOST_NODES}")
    _alone(given)
    nodes = iter(given.tree)
    if given.ends is None:
        count = _leaves(statement, arm, given, nodes, None)
    else:  # each hold is one of both
        every = (Along(given.ends, beyond) for beyond in (True, False))
        count = sum(_leaves(statement, arm, given, nodes, along) for along in every)
    if next(nodes, None) is not None:
        raise InputError("the proof's tree goes on after its end", allowed="a whole tree")
    return count


def _leaves(
    statement: Statement, arm: Arm, given: Refutation, nodes: Iterator[int], along: Along | None
) -> int:
    """The same of holds that have the handle along the fingers so; of all, where that is None."""
    if given.grasped:
        return _grasps(statement, arm, given, nodes)
    if given.between:
        statement, arm = between(statement, given, along)
    if given.pinched:
        return _pinches(statement, given, nodes)
    box = _covered(given, tuple(link.name for link in arm.chain.links), *arm.chain.ranges())
    if given.steps is not None:
        return refuted_steps(statement, arm, given, nodes, box)
    if given.places is not None:
        return refuted_places(statement, arm, given.places, nodes, box)
    goal = replace(at_value(statement, arm, given.value), beside=_limbs(statement, arm, given))
    return refuted_boxes(goal, nodes, *box)


def _limbs(statement: Statement, arm: Arm, given: Refutation) -> tuple[Beside, ...]:
    """Limbs to which a refutation goes over, with the container at its value."""
    return tuple(statement.beside(arm, body, given.value, given.parked) for body in given.beside)


def _grasps(statement: Statement, arm: Arm, given: Refutation, nodes: Iterator[int]) -> int:
    """The same of grasps of a bar.

    Raises:
        InputError: One is not refuted, or the claim is about other holds, or the refutation about more.
    """
    about = given.gripper, given.value, given.joints, given.box, given.tree
    if statement.bar is None or given != Refutation(
        *about, beside=given.beside, parked=given.parked, grasped=True
    ):
        raise InputError(
            "a refutation of grasps of a bar", allowed="a claim about these, one value, arm and limbs alone"
        )
    grasps = Grasps(statement, arm, statement.bar, given.value, _limbs(statement, arm, given))
    names = (*(link.name for link in arm.chain.links), *COORDINATES)
    return refuted_grasps(grasps, nodes, *_covered(given, names, *grasps.ranges()))


def _alone(given: Refutation) -> None:
    """Limbs and steps are of trees of the arm's joints alone, parted fingers of two at one value.

    Raises:
        InputError: They come with places or with fingers.
    """
    if given.ends is not None and (not given.between or given.places is not None or given.steps is not None):
        raise InputError("fingers that are parted", allowed="a handle between two fingers at one value")
    if (given.beside or given.steps is not None) and (given.pinched or given.places is not None):
        raise InputError("a tree of places or fingers that goes over to limbs", allowed="one of arms alone")


def between(statement: Statement, given: Refutation, along: Along | None = None) -> tuple[Statement, Arm]:
    """The same of the handle between two fingers, and the gripper's arm with that in place of its grasp box.

    At the value that the container has before it moves nothing has slipped; a hold at several values has.

    Raises:
        InputError: There are no two fingers, or it is about fingers one by one, or about holds in hand.
    """
    begins = given.places is None and given.value == statement.twin.state[statement.container.joint]
    other = statement.between(begins, along)
    (gripper,) = (one for one in statement.grippers if one.name == given.gripper)
    arm = None if given.pinched else other.arm(gripper)
    if arm is None:
        raise InputError("a handle between two fingers", allowed="two fingers, and a tree of the arm alone")
    return other, arm


def _pinches(statement: Statement, given: Refutation, nodes: Iterator[int]) -> int:
    """The same where it is refuted that two fingers come to the handle together.

    Raises:
        InputError: One is not, or the tree does not cover all positions of arm and fingers.
    """
    (gripper,) = (one for one in statement.grippers if one.name == given.gripper)
    hand, target = statement.hand(gripper), statement.target(given.value)
    if hand is None or not len(target.boxes):
        raise InputError(
            "a proof from two fingers", allowed="a free base, two fingers, a handle with a shape"
        )
    box = _covered(given, hand.names, hand.low, hand.high)
    near = statement.near(hand, given.value)
    return refuted_pinches(hand, handle_span(target), near, nodes, box)


def _covered(given: Refutation, names: tuple[str, ...], lowest: Array, highest: Array) -> tuple[Array, Array]:
    """Lower and upper ends of the refuted box.

    Raises:
        InputError: It is about other joints, or not about all positions of these.
    """
    if given.joints != names or len(given.box) != len(names):
        raise InputError("the proof is about other joints", allowed=", ".join(names))
    low, high = (np.array([end[k] for end in given.box]).reshape(-1) for k in (0, 1))
    for name, a, b, least, most in zip(names, low, high, lowest, highest, strict=True):
        if a > least or b < most:
            raise InputError(
                f"{name} may be beyond {a:.4g} to {b:.4g}", allowed=f"all of {least:.4g} to {most:.4g}"
            )
    return low, high
