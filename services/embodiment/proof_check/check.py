"""Whether a proof of infeasibility holds, in interval arithmetic and without the code that found it."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError, SdtError
from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.arm import ROUNDING, Arm
from services.embodiment.proof_check.content import (
    IN_HAND,
    LEAF,
    Claim,
    Proof,
    Refutation,
    Timing,
    read_proof,
)
from services.embodiment.proof_check.cores import Solids, pierced
from services.embodiment.proof_check.haste import too_fast
from services.embodiment.proof_check.interval import Interval, apply, cross, exact
from services.embodiment.proof_check.mechanics import Chain, Placement, levers
from services.embodiment.proof_check.statement import Statement, Target

Array = NDArray[np.float64]

BLOCK = 2048  # leaves that are checked at once
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

    Raises:
        InputError: The content is no proof, or damaged.
    """
    proof = read_proof(content)
    claim = proof.claim
    reasons = [*_differs(twin, robot, container, claim)]
    leaves = 0
    if not reasons:
        about = twin, robot, container, claim.drive, claim.start, claim.tolerances
        statement = Statement(*about, within=claim.within)
        if claim.timing is not None:
            reasons += _hurried(statement, proof, claim.timing)
        else:
            found, leaves = refuted(statement, claim.span, proof.refutations)
            reasons += found
    if claim.timing is not None:
        sentence = f"no certified motion of {local_name(robot)} moves {container.name} in the given times"
        return Checked(tuple(reasons), sentence, proof.assumptions(), leaves)
    values = sorted({f"{one.value:.4g}" for one in proof.refutations})
    past = ", ".join(values) or "any value"
    meant = "" if claim.within is None else f"with {local_name(container.handle)} in hand "
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


def _differs(twin: Twin, robot: Iri, container: Container, claim: Claim) -> Iterator[str]:
    """Where the claim is about something else than what it is checked for."""
    for model, (claimed, known) in zip((twin.environment, robot), claim.models, strict=True):
        if claimed != model:
            yield f"the proof is about {local_name(claimed)}, not about {local_name(model)}"
        elif twin.content_hash(model) != known:
            yield f"{local_name(model)} has changed since the proof was made"
    if claim.container != container.iri:
        yield f"the proof is about {local_name(claim.container)}, not about {container.name}"
    if dict(twin.state) != claim.state:
        yield "the proof is about another state of the kitchen"
    if claim.tolerances != Tolerances():
        yield f"the proof holds for other tolerances than this version's: {claim.tolerances}"
    if claim.within is not None and (claim.within != IN_HAND or claim.timing is not None):
        yield f"the proof is about holds within {claim.within:g} m, in hand are those within {IN_HAND:g} m"
    yield from _not_needed(container, twin.state[container.joint], claim.span)


def _not_needed(container: Container, at: float, span: tuple[float, float]) -> Iterator[str]:
    """Where the container can open or close without passing all of the span."""
    low, high = span
    if not low <= at <= high:
        yield f"the container is at {at:.4g}, outside the values that it has to pass, {low:.4g} to {high:.4g}"
    opens, closes = low >= at and high <= container.open_from, high <= at and low >= container.closed_to
    if not (opens or closes) and low < high:
        yield f"the container need not pass all of {low:.4g} to {high:.4g} to open or close"


def refuted(
    statement: Statement, span: tuple[float, float], refutations: tuple[Refutation, ...]
) -> tuple[list[str], int]:
    """Why the refutations do not cover every gripper, and how many boxes were refuted."""
    reasons: list[str] = []
    given = {one.gripper: one for one in refutations}
    leaves = 0
    for gripper in statement.grippers:
        one, arm = given.get(gripper.name), statement.arm(gripper)
        if one is None:
            reasons.append(f"gripper {gripper.name} is not refuted")
        elif arm is None:
            reasons.append(f"gripper {gripper.name} has no fingers with shapes that move with its tool")
        elif not span[0] <= one.value <= span[1]:
            reasons.append(f"the container need not pass {one.value:.4g}, at which {gripper.name} is refuted")
        else:
            try:
                leaves += _tree(statement, arm, one)
            except SdtError as error:
                reasons.append(f"gripper {gripper.name}: {error}")
    if not statement.grippers:
        reasons.append("the robot has no gripper: nothing to refute")
    return reasons, leaves


def _tree(statement: Statement, arm: Arm, given: Refutation) -> int:
    """Number of leaves, each of which is refuted.

    Raises:
        InputError: One is not, or the tree does not cover all joint positions.
    """
    links = arm.chain.links
    if given.joints != tuple(link.name for link in links) or len(given.box) != len(links):
        raise InputError("the proof is about other joints", allowed=", ".join(one.name for one in links))
    low, high = (np.array([end[k] for end in given.box]).reshape(-1) for k in (0, 1))
    for link, a, b in zip(links, low, high, strict=True):
        if a > link.lower or b < link.upper:
            raise InputError(
                f"{link.name} may be beyond {a:.4g} to {b:.4g}",
                allowed=f"all of {link.lower:.4g} to {link.upper:.4g}",
            )
    target = statement.target(given.value)
    if not len(target.boxes):
        raise InputError("the handle has no shape", allowed="a handle with collision geometry")
    around = statement.around(arm, given.value)
    leaves, count = _leaves(given.tree, low, high, len(arm.cores)), 0
    while block := list(islice(leaves, BLOCK)):
        count += len(block)
        far = [leaf for leaf in block if leaf[2] <= len(links)]
        if far:
            _all_far(arm, target, far, statement.level)
        if len(far) < len(block):
            _all_pierced(arm, around, [leaf for leaf in block if leaf[2] > len(links)])
    return count


def _leaves(tree: bytes, low: Array, high: Array, cores: int) -> Iterator[tuple[Array, Array, int]]:
    """Boxes of the leaves, and what each of them names; together they are the whole box.

    Raises:
        InputError: The tree ends early, goes on after its end, or names joints that are not there.
    """
    if len(tree) > MOST_NODES:
        raise InputError(f"a tree of {len(tree)} nodes", allowed=f"at most {MOST_NODES}")
    stack, nodes = [(low, high)], iter(tree)
    while stack:
        low, high = stack.pop()
        node = next(nodes, None)
        named = len(low) + (1 + cores if node is not None and node >= LEAF else 0)
        if node is None or node % LEAF >= named:
            raise InputError("the proof's tree is damaged", allowed="a whole tree over the arm's joints")
        if node >= LEAF:
            yield low, high, node - LEAF
            continue
        middle = (low[node] + high[node]) / 2
        upper_low, lower_high = low.copy(), high.copy()
        upper_low[node], lower_high[node] = middle, middle
        stack.append((upper_low, high))
        stack.append((low, lower_high))
    if next(nodes, None) is not None:
        raise InputError("the proof's tree goes on after its end", allowed="a whole tree")


def _all_pierced(
    arm: Arm, around: tuple[Solids, NDArray[np.bool_]], block: list[tuple[Array, Array, int]]
) -> None:
    """In each box the named core has a point of something solid in it.

    Raises:
        InputError: It has none, as far as was shown.
    """
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    named = np.array([one[2] for one in block]) - len(arm.chain.links) - 1
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
    solids, keeps = around
    for c in np.unique(named):
        of, core = named == c, arm.cores[c]
        if not (pierced(core, arm.chain, solids, keeps[c], (middle[of], half[of])) > 0).all():
            raise InputError(
                f"{core.body} can be clear of everything solid, as far as was shown", allowed="a collision"
            )


def _all_far(arm: Arm, target: Target, block: list[tuple[Array, Array, int]], level: bool) -> None:
    """In each box the named joint's origin is farther from the handle than its arm reaches.

    Behind the last joint comes the grasp box itself, all of which is apart from the handle.

    From the middle of a box, moving its joints one after the other from the base outwards, the
    origin moves by at most its distance from each axis, as it is in the middle, times the way to the
    box's end.

    Raises:
        InputError: It is not.
    """
    low, high = (np.array([one[k] for one in block]) for k in (0, 1))
    named = np.array([one[2] for one in block])
    middle = (low + high) / 2
    half = np.maximum(high - middle, middle - low) * (1 + 1e-12)
    origins, axes, tool = arm.chain.frames(middle)
    for k in np.unique(named):
        of = named == k
        if k == len(arm.chain.links):
            at = Placement(tool.rotation[of], tool.translation[of])
            _box_apart(arm, target, at, (origins[of], axes[of], half[of]), level)
            continue
        arms = levers(origins[of], axes[of], int(k), arm.chain.links)
        if level:
            arms = np.where(
                np.arange(k + 1) < arm.upright, rises(arm.chain, axes[of].magnitude().hi)[:, : k + 1], arms
            )
        moved = (arms * half[of, : k + 1]).sum(axis=1) * (1 + 1e-12)
        apart = target.distance(origins[of][:, k], level) - moved
        short = np.flatnonzero(~(apart > arm.reach[k] + ROUNDING))
        if len(short):
            name = arm.chain.links[k].name
            worst = float(apart[short].min())
            raise InputError(
                f"{name} can come as near as {worst:.4f} m to the handle, as far as was shown",
                allowed=f"more than {arm.reach[k]:.4f} m, its distance to the fingers",
            )


def _box_apart(
    arm: Arm, target: Target, tool: Placement, joints: tuple[Interval, Interval, Array], level: bool
) -> None:
    """The grasp box is apart from the handle: no point of it moves farther than the gap in the middle.

    Raises:
        InputError: It is not, as far as was shown.
    """
    origins, axes, half = joints
    last = len(arm.chain.links)
    centre = apply(tool.rotation, exact(arm.middle)) + tool.translation
    turns = np.array([link.turns for link in arm.chain.links])
    radius = float(np.linalg.norm(arm.half)) * (1 + 1e-12)
    arms = cross(centre[:, None] - origins, axes).norm().hi + radius
    arms = np.where(turns, arms, 1.0)
    if level:
        arms = np.where(np.arange(last) < arm.upright, rises(arm.chain, axes.magnitude().hi), arms)
    moved = (arms * half).sum(axis=1) * (1 + 1e-12)
    gap = target.gap(Placement(tool.rotation, centre), arm.half, level) - moved
    if not (gap > 0).all():
        raise InputError(
            f"the fingers can come to the handle: {float(gap.min()):.4f} m between them, as far as was shown",
            allowed="a gap",
        )


def rises(chain: Chain, axes: Array) -> Array:
    """How far an upright joint lifts what it carries for a unit of it; `axes` are magnitudes (L, n, 3)."""
    slides = np.array([not link.turns for link in chain.links])
    return np.where(slides, axes[:, :, 2], 0.0)
