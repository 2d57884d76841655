"""What a refusal says where a container has several handles, or moves with others that have theirs."""

from dataclasses import replace

from predicates.case import Answer
from sdt_kg.iri import local_name
from sdt_kg.twin import Container


def of_one_handle(answer: Answer, container: Container, others: tuple[Container, ...]) -> Answer:
    """A refusal of a container; where there are other handles that move it, nothing is proved of them.

    Args:
        answer: About its own handle; those of the others were looked for in vain.
        container: What is refused.
        others: Containers that move with it.
    """
    looked = [local_name(each.handle) for each in others]
    passed = [local_name(more) for each in (container, *others) for more in each.more_handles]
    if not looked and not passed:
        return answer
    said = (f"nor by {', '.join(looked)}, which move with it, as far as was looked",) if looked else ()
    said += (f"not looked for by {', '.join(passed)}, which move it, too",) if passed else ()
    said = (*answer.notes, *said, f"what is said is of {local_name(container.handle)}")
    if answer.artefact is None or not any(each.proof for each in answer.diagnoses):
        return replace(answer, notes=said)
    diagnoses = tuple(replace(each, proof=False) for each in answer.diagnoses)
    return replace(answer, diagnoses=diagnoses, notes=said, artefact=None)
