"""What is said where a container has several handles, or moves with others that have theirs."""

from collections.abc import Sequence
from dataclasses import replace

from predicates.case import Answer
from sdt_kg.iri import local_name
from sdt_kg.twin import Container


def held_by(container: Container, other: Container) -> str:
    """What a certificate of a container says that is moved by another handle than its own."""
    handle = local_name(other.handle)
    if other.iri == container.iri:
        return f"held by {handle}, another handle of {container.name}"
    return f"held by {handle}: {container.name} moves with {other.name}"


def of_one_handle(answer: Answer, container: Container, others: Sequence[Container], left: int) -> Answer:
    """A refusal of a container; where there are other handles that move it, nothing is proved of them.

    Args:
        answer: About its own handle.
        container: What is refused.
        others: By another handle each.
        left: How many of them, the last ones, were not looked for; the others were, in vain.
    """
    if not others:
        return answer
    names = [local_name(each.handle) for each in others]
    looked, passed = ", ".join(names[: len(names) - left]), ", ".join(names[len(names) - left :])
    said = (f"nor by {looked}, as far as was looked",) if looked else ()
    said += (f"not looked for by {passed}, where the force would be another",) if passed else ()
    said = (*answer.notes, *said, f"what is said is of {local_name(container.handle)}")
    if answer.artefact is None or not any(each.proof for each in answer.diagnoses):
        return replace(answer, notes=said)
    diagnoses = tuple(replace(each, proof=False) for each in answer.diagnoses)
    return replace(answer, diagnoses=diagnoses, notes=said, artefact=None)
