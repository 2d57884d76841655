"""Proofs by several handles of one container, or of ones that move together: are they about one question?"""

from collections.abc import Iterator

from sdt_kg.entities.coupling import LIMIT_TOLERANCE
from sdt_kg.twin import Container, Twin
from services.embodiment.proof_check.proof.content import Proof


def another_question(twin: Twin, container: Container, own: Proof, other: Proof) -> Iterator[str]:
    """In what a proof by another handle is about less than the one by the container's own is.

    The base may start elsewhere: where the kitchen says so it is turned to the handle that is held.
    """
    claim, one = own.claim, other.claim
    if one.partial:
        yield "its proof is about some holds, one hold, or collision shapes alone"
    if one.drive is not claim.drive:
        yield f"its proof is for the base policy {one.drive.value}, not {claim.drive.value}"
    if one.timing is not None and (one.timing != claim.timing or one.container != claim.container):
        yield "its proof is about times that are not those asked for"
    low, high, slack = *claim.span, 0.0
    if one.container != claim.container:
        low, high = _passed(twin, container, claim.span, twin.container(one.container))
        slack = LIMIT_TOLERANCE
    if one.span[0] < low - slack or one.span[1] > high + slack:
        yield f"its container need not pass all of {one.span[0]:.4g} to {one.span[1]:.4g}"


def _passed(
    twin: Twin, container: Container, span: tuple[float, float], other: Container
) -> tuple[float, float]:
    """What another container passes while one that moves with it passes a span [rad or m]."""
    ratio, offset = twin.entities.coupling.together(container.joint)[other.joint]
    ends = [ratio * value + offset for value in span]
    return min(ends), max(ends)
