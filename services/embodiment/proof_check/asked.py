"""Whether a proof is about what it is checked for: models, state, tolerances, container and its values."""

from collections.abc import Iterator

from sdt_kg.iri import Iri, local_name
from sdt_kg.twin import Container, Twin
from services.embodiment.certify.tolerances import Tolerances
from services.embodiment.proof_check.proof.claim import Claim, other_handle
from services.embodiment.proof_check.proof.content import IN_HAND


def differs(twin: Twin, robot: Iri, container: Container, claim: Claim) -> Iterator[str]:
    """Where the claim is about something else than what it is checked for."""
    yield from _other_models(twin, robot, container, claim)
    if dict(twin.state) != claim.state:
        yield "the proof is about another state of the kitchen"
    if claim.tolerances != Tolerances():
        yield f"the proof holds for other tolerances than this version's: {claim.tolerances}"
    if claim.within is not None and (claim.within != IN_HAND or claim.timing is not None):
        yield f"the proof is about holds within {claim.within:g} m, in hand are those within {IN_HAND:g} m"
    if claim.bar is not None and claim.within is not None:
        yield "the proof is about holds in hand and about grasps of a bar, and says of each that it is all"
    yield from _not_needed(container, twin.state[container.joint], claim.span)


def _other_models(twin: Twin, robot: Iri, container: Container, claim: Claim) -> Iterator[str]:
    """Where the claim is about another kitchen, robot, container or handle."""
    for model, (claimed, known) in zip((twin.environment, robot), claim.models, strict=True):
        if claimed != model:
            yield f"the proof is about {local_name(claimed)}, not about {local_name(model)}"
        elif twin.content_hash(model) != known:
            yield f"{local_name(model)} has changed since the proof was made"
    if claim.container != container.iri:
        yield f"the proof is about {local_name(claim.container)}, not about {container.name}"
    elif claim.handle != other_handle(twin, container):
        yield f"the proof is not about {local_name(container.handle)}, but about another handle"


def _not_needed(container: Container, at: float, span: tuple[float, float]) -> Iterator[str]:
    """Where the container can open or close without passing all of the span.

    It may be short of that by rounding (`ROUNDING` of sdt_kg.state), by which boxes of a proof are larger.
    """
    low, high = span
    if not low <= at <= high:
        yield f"the container is at {at:.4g}, outside the values that it has to pass, {low:.4g} to {high:.4g}"
    opens, closes = low >= at and high <= container.open_from, high <= at and low >= container.closed_to
    if not (opens or closes) and low < high:
        yield f"the container need not pass all of {low:.4g} to {high:.4g} to open or close"
