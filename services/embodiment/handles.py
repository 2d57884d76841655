"""What is said where a container has several handles, or moves with others that have theirs."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from predicates.case import Answer, Artefact, ArtefactKind
from predicates.meant import handles_of_no_container
from sdt_kg.iri import local_name
from sdt_kg.task import UNKNOWN
from sdt_kg.twin import Container, Twin
from services.embodiment.proof_check import check
from services.embodiment.proof_check.proof.written import read_proof, to_bytes

DRIVE = "drive: "
"""How the note begins that says how the base moves."""
START = "start: "
"""How the note begins that says where the robot starts."""
GIVEN = "the body motion was given; it was only checked"


def held_by(container: Container, held: Container) -> tuple[str, ...]:
    """What a certificate of a container says that is moved by another handle than its own."""
    handle = local_name(held.handle)
    if held.iri != container.iri:
        return (f"held by {handle}: {container.name} moves with {held.name}",)
    return () if held == container else (f"held by {handle}, another handle of {container.name}",)


def refused(twin: Twin, answers: Sequence[Answer], by: Sequence[Container]) -> Answer:
    """The refusal of a container: proved, where it is by each handle that moves it.

    Args:
        twin: Of the case.
        answers: By its own handle, then by each other one that was looked for, perhaps not the last ones.
        by: The container by its own handle, then what is moved by each other one.
    """
    (answer, *more), (container, *others) = answers, by
    beyond = ", ".join(map(local_name, handles_of_no_container(twin, container)))
    if not others and not beyond:
        return answer
    names = [local_name(each.handle) for each in others]
    looked, passed = ", ".join(names[: len(more)]), ", ".join(names[len(more) :])
    if not passed and (artefact := _joined(twin, answers, container)) is not None:
        diagnoses = tuple(each for one in answers for each in one.diagnoses)
        proved = f"proved of {local_name(container.handle)} and of {looked}"
        said = (*answer.notes, *_starts(answers, names), proved)
        return replace(answer, diagnoses=diagnoses, notes=said, artefact=artefact)
    said = (*_starts(answers, names), *((f"nor by {looked}, as far as was looked",) if looked else ()))
    said += (f"not looked for by {passed}, where the force would be another",) if passed else ()
    said += (f"not looked for by {beyond}, which is no container's",) if beyond else ()
    said = (*answer.notes, *said, f"what is said is of {local_name(container.handle)}")
    if _proved(answer) is None:
        return replace(answer, notes=said)
    diagnoses = tuple(replace(each, proof=False) for each in answer.diagnoses)
    return replace(answer, diagnoses=diagnoses, notes=said, artefact=None)


def _starts(answers: Sequence[Answer], others: Sequence[str]) -> Iterator[str]:
    """Where the robot started for each other handle, if elsewhere: it is turned to the one that is held."""
    for answer, handle in zip(answers[1:], others, strict=False):
        yield from (
            f"for {handle} {note}"
            for note in answer.notes
            if note.startswith(START) and note not in answers[0].notes
        )


def _proved(answer: Answer) -> Artefact | None:
    """The answer's proof, if it has a whole one."""
    return answer.artefact if any(each.proof for each in answer.diagnoses) else None


def _joined(twin: Twin, answers: Sequence[Answer], container: Container) -> Artefact | None:
    """One proof by all handles, if there is one by each, and together they hold."""
    found = [read_proof(each.content) for each in map(_proved, answers) if each is not None]
    robot = answers[0].case.robot
    if len(found) < len(answers) or robot is UNKNOWN:
        return None
    content = to_bytes(replace(found[0], others=tuple(found[1:])))
    return Artefact(ArtefactKind.PROOF, content) if check(twin, robot, container, content).holds else None
