"""What was proved: a diagnosis, and the artefact that shows it."""

from dataclasses import dataclass

from predicates.case import Artefact, Diagnosis


@dataclass(frozen=True, slots=True)
class Proved:
    """A verified proof.

    Attributes:
        boxes: Of joint positions that were refuted one by one.
    """

    diagnosis: Diagnosis
    artefact: Artefact
    boxes: int
