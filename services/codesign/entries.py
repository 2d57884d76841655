"""What a grid says of one container, robot and world: small enough to travel between processes."""

from dataclasses import dataclass, field
from enum import Enum

from predicates.case import Artefact, Outcome, Verdict
from predicates.record import Record, diagnosis_json
from predicates.record.report import answers
from sdt_kg.errors import InputError
from services.codesign.again import Swept

Json = dict[str, object]
Holds = dict[str, bool | None]


class How(Enum):
    """Where an entry's outcome is from."""

    LAW = "asked anew"
    KEPT = "kept from before"
    SAME = "same question as it is"
    AGAIN = "motion of the world as it is, certified again"
    CAUSES = "refused before CanPerform, which was not asked"
    NOTHING = "search of the world as it is: nothing that it rests on differs"
    LESS_ROOM = "search of the world as it is, of which this one only takes room away"
    NO_WORLD = "the edit cannot be made here"
    LOST = "no verdict: nothing came of it"


REUSED = frozenset({How.SAME, How.AGAIN, How.NOTHING, How.LESS_ROOM})
"""Where no body motion was searched since one was searched in the world as it is."""


@dataclass(frozen=True, slots=True)
class Found:
    """An outcome, and what it rests on.

    Attributes:
        iri: Of the verdict; of that in the world as it is where the search is its own.
        outcome: None where there is no such world, or no verdict.
        holds: Predicate → whether it holds; None: not asked.
        diagnoses: As `sdt achieve --json` has them.
        artefact: Certificate or proof; None where there is none, or where it is another world's.
        swept: Pairs of shapes that were swept, where a motion was certified again.
        seconds: CPU time [s].
        record: To be kept; only of a verdict about the world as it is.
    """

    iri: str
    outcome: Outcome | None
    how: How
    holds: Holds
    diagnoses: tuple[Json, ...] = ()
    artefact: Artefact | None = None
    swept: Swept | None = None
    seconds: float = 0.0
    record: Record | None = None

    @property
    def is_certified(self) -> bool:
        """Whether it is certified."""
        return self.outcome is Outcome.CERTIFIED

    @property
    def is_proved(self) -> bool:
        """Whether a refusal rests on a proof."""
        return any(each["proof"] is True for each in self.diagnoses)

    @property
    def basis(self) -> str:
        """What a refusal rests on: `proved`, `measured`, or `searched` where that is all; else nothing."""
        if self.outcome is not Outcome.NOT_CERTIFIED:
            return ""
        if self.is_proved:
            return "proved"
        return "searched" if all(each["search"] is not None for each in self.diagnoses) else "measured"


@dataclass(frozen=True, slots=True)
class Entry:
    """One case of a grid.

    Attributes:
        robot: As it was given; the edit may put another in its place.
        edits: What is otherwise; empty: the world as it is.
    """

    kitchen: str
    robot: str
    container: str
    edits: tuple[str, ...]
    found: Found

    @property
    def key(self) -> tuple[str, str, str]:
        """What the entry has in common with that of the world as it is."""
        return self.kitchen, self.robot, self.container


@dataclass(slots=True)
class Grid:
    """All entries, those of the worlds as they are first.

    Attributes:
        seconds: Wall time [s].
        cpu_seconds: CPU time of this process and its workers [s].
    """

    entries: list[Entry] = field(default_factory=list[Entry])
    seconds: float = 0.0
    cpu_seconds: float = 0.0

    def actual(self) -> dict[tuple[str, str, str], Entry]:
        """Kitchen, robot, container → its entry in the world as it is."""
        return {each.key: each for each in self.entries if not each.edits}

    def edited(self) -> list[Entry]:
        """Cells of all other worlds."""
        return [each for each in self.entries if each.edits]

    def turned(self) -> list[tuple[Entry, Entry]]:
        """The entry as it is and otherwise, where the outcome turns."""
        actual = self.actual()
        pairs = ((actual[each.key], each) for each in self.edited())
        return [
            (one, other)
            for one, other in pairs
            if None not in {one.found.outcome, other.found.outcome}
            and one.found.outcome is not other.found.outcome
        ]


def found_of(verdict: Verdict, how: How, seconds: float, swept: Swept | None = None) -> Found:
    """What a grid keeps of a verdict."""
    holds = {name: None if one is None else one.holds for name, one in answers(verdict).items()}
    artefact = None if verdict.can_perform is None else verdict.can_perform.artefact
    said = tuple(diagnosis_json(each) for each in verdict.diagnoses)
    return Found(verdict.iri, verdict.outcome, how, holds, said, artefact, swept, seconds)


def no_world(error: InputError) -> Found:
    """That an edit cannot be made here."""
    return _nothing(How.NO_WORLD, "no world", str(error))


def lost(reason: str) -> Found:
    """That a case ended the process that judged it, or failed there: nothing is known of it."""
    return _nothing(How.LOST, "no verdict", reason)


def _nothing(how: How, kind: str, reason: str) -> Found:
    said: Json = {"kind": kind, "reason": reason, "evidence": None, "proof": False, "search": None}
    return Found("", None, how, {}, (said,))
