"""A lift that is in the way of a container: each part of it is refuted at a value of its own.

Both are continuous in time, and the lift stays within its limits. Let the lift be divided in equal parts,
part k refuted with the container at value v_k; and where two parts meet, let everything between their
values be refuted with the lift just there. These *steps* go from one end of the lift to the other, so they
part what begins below all of the values from what ends above them (or the other way round): a motion that
takes the container past them all meets a step at some time. What is in the way there is a limb, whether the
handle is held then or, the container at rest, let go: of the arm's own tree, which is about holds, nothing
is taken.

Between two values the container is in one of several pieces, the lift where both parts meet: there a limb
has to be in the way wherever the container is in the piece. Nothing is asked of the gripper there. What else
follows the container's joint would be elsewhere in the piece, too: where a joint does, no steps are taken.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.mechanism import JointType
from sdt_kg.motion import BASE_JOINTS
from services.embodiment.proof_check.arm import Arm
from services.embodiment.proof_check.places import at_value
from services.embodiment.proof_check.proof.content import LEAF, Refutation, Steps
from services.embodiment.proof_check.statement import Statement
from services.embodiment.proof_check.tree import refuted_limb

Array = NDArray[np.float64]

LIFT = len(BASE_JOINTS)
"""Index of the first joint behind the base."""
WIDER = 1e-9  # [1] and [rad or m] by which a piece is taken wider, for rounding


def refuted_steps(
    statement: Statement, arm: Arm, given: Refutation, nodes: Iterator[int], box: tuple[Array, Array]
) -> int:
    """Number of leaves of all trees, each of which is refuted; the steps go all the way up the lift.

    Args:
        statement: What is to be refuted.
        arm: One gripper's.
        given: The refutation, with steps.
        nodes: Of the trees: of each part, and before it, of the pieces on the way from the value before.
        box: Lower and upper ends of the joints' positions, shape (n,).

    Raises:
        InputError: One is not, or these are no such steps.
    """
    assert given.steps is not None
    steps, (low, high), count = given.steps, box, 0
    _allowed(statement, arm, given, steps)
    edges = np.linspace(low[LIFT], high[LIFT], len(steps.values) + 1)
    for k, value in enumerate(steps.values):
        if k and steps.values[k - 1] != value:
            ends = np.linspace(steps.values[k - 1], value, steps.pieces[k - 1] + 1)
            part = _at(low, edges[k]), _at(high, edges[k])
            for between in pairwise(ends.tolist()):
                count += _refuted_piece(statement, arm, given, nodes, part, between)
        node = next(nodes, -1) - LEAF - at_value(statement, arm, value).codes
        if not 0 <= node < len(given.beside):
            raise InputError("a part of a lift that no limb is in the way of", allowed="a limb for each part")
        one = statement.beside(arm, given.beside[node], value, given.parked)
        count += refuted_limb(one, nodes, _at(low, edges[k]), _at(high, edges[k + 1]))
    return count


def piece(ends: tuple[float, float]) -> tuple[float, float]:
    """The middle of a piece, and how far the container is from there at most [rad or m]."""
    first, last = ends
    return (first + last) / 2, abs(last - first) / 2 * (1 + WIDER) + WIDER


def _refuted_piece(  # noqa: PLR0913, PLR0917  # what is to be refuted, and where
    statement: Statement,
    arm: Arm,
    given: Refutation,
    nodes: Iterator[int],
    box: tuple[Array, Array],
    ends: tuple[float, float],
) -> int:
    """The same of one piece: the first node is which limb is in the way, then comes its tree.

    Raises:
        InputError: It is not, as far as was shown.
    """
    node = next(nodes, None)
    if node is None or node >= len(given.beside):
        raise InputError("the proof's tree is damaged", allowed="a limb for each piece between two values")
    value, wide = piece(ends)
    one = statement.beside(arm, given.beside[node], value, given.parked, wide)
    return refuted_limb(one, nodes, *box)


def _allowed(statement: Statement, arm: Arm, given: Refutation, steps: Steps) -> None:
    """The lift has ends of its own, and the container passes each value exactly, followed by no other joint.

    Raises:
        InputError: It is not so.
    """
    if statement.level:
        raise InputError("steps of a lift with a free base", allowed="a fixed base")
    joint = statement.twin.mechanism(statement.robot).joint(arm.chain.links[LIFT].name)
    if joint.type is JointType.CONTINUOUS or joint.mimic is not None:
        raise InputError(f"steps of {joint.name}", allowed="a joint with limits of its own")
    own, kitchen = local_name(statement.container.joint), statement.twin.mechanism(statement.twin.environment)
    if follows := [each.name for each in kitchen.joints if each.mimic and each.mimic.joint == own]:
        raise InputError(f"steps of {own}, which {follows[0]} follows", allowed="a joint that none follows")
    if not steps.values or given.value != steps.values[0] or len(steps.pieces) != len(steps.values) - 1:
        raise InputError("steps that do not fit each other", allowed="a value for each part, and its ways")
    if sum(steps.pieces) > len(given.tree):
        raise InputError("more pieces than the tree has nodes", allowed="a tree for each piece")
    if any(not count for (a, b), count in zip(pairwise(steps.values), steps.pieces, strict=True) if a != b):
        raise InputError("a step up or down that nothing refutes", allowed="one piece and more")
    if beyond := [value for value in steps.values if not statement.passing.is_passed(value)]:
        raise InputError(f"the container need not be exactly at {beyond[0]:.4g}", allowed="what it passes")


def _at(ends: Array, lift: float) -> Array:
    other = ends.copy()
    other[LIFT] = lift
    return other
