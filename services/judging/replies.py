"""What is answered: the same over Zenoh and over HTTP."""

from typing import Any, Literal

from pydantic import BaseModel, Field

from services.judging.messages import Message, Verb


class Reply(Message):
    """Any of them; over Zenoh the reply's key names who answered."""


class VersionReply(Reply):
    """Of `@meta/version`: the server's name."""

    instance: str


class MetRequest(BaseModel):
    """A request that a state meets."""

    verb: str
    container: str


class SatisfiesReply(Reply):
    """Of satisfies."""

    requests: list[MetRequest]


class CausesReply(Reply):
    """Of causes: one answer for each motion.

    Attributes:
        tasks: What each answer is about; the container as an IRI.
        motions: τ where it holds: joint, times [s], values [rad or m].
        answers: The objects of `sdt causes --json`.
    """

    tasks: list[MetRequest | None] = Field(default_factory=list)
    holds: list[bool]
    diagnoses: list[list[dict[str, Any]]]
    motions: list[dict[str, Any] | None]
    answers: list[dict[str, Any]] = Field(default_factory=list)


class VerdictsReply(Reply):
    """Of canachieve and canperform: the objects of `sdt achieve --json`.

    Attributes:
        quads: The verdicts as N-Quads, where asked for.
        motions: Γ of each verdict, where asked for and certified: arrays as in a motion file.
    """

    verdicts: list[dict[str, Any]]
    quads: str | None = None
    motions: list[dict[str, Any] | None] | None = None


class PlaceReply(Reply):
    """Of place: the object of `sdt place --json`."""

    placement: dict[str, Any]


class WhatIfReply(Reply):
    """Of whatif: the object of `sdt whatif --json`.

    Attributes:
        answer: The verdict as it is, the other one, and what differs; or the smallest change of each kind; or
            the cases of a grid.
        quads: Its verdicts as N-Quads, where asked for; where no single world is named, those as it is.
    """

    answer: dict[str, Any]
    quads: str | None = None


class TaskReply(Reply):
    """Of task: the object of `sdt task --json`.

    Attributes:
        result: What became of the task, its steps and rules.
        quads: The result and the verdicts of its steps as N-Quads, where asked for.
    """

    result: dict[str, Any]
    quads: str | None = None


class ComputeReply(Reply):
    """Of compute.

    Attributes:
        computed: What was judged, and what was left out and why.
    """

    computed: dict[str, Any]


class ToldSection(BaseModel):
    """One part of a story."""

    title: str
    lines: list[str]


class TextReply(Reply):
    """Of why: the story, and the same part by part, as `sdt why --json` prints it."""

    text: str
    sections: list[ToldSection] = Field(default_factory=list)


class EventTold(BaseModel):
    """An event as it was published: its key, and the triples of what happened."""

    sequence: int
    key: str
    quads: str


class HistoryReply(Reply):
    """Of history.

    Attributes:
        epoch: Of the numbering; where another one was asked about, `restarted` is true.
        first, last: Numbers of the oldest and newest event that are kept; 0 where there is none.
        gap: First and last number that was asked for and is not kept any more.
        restarted: The numbers have begun anew since the asker's: these are from the oldest on.
        more: Whether there are newer ones than those told.
    """

    epoch: str
    first: int
    last: int
    gap: tuple[int, int] | None = None
    restarted: bool = False
    more: bool = False
    events: list[EventTold] = Field(default_factory=list)


class JobReply(Reply):
    """Of sweep, and of progress.

    Attributes:
        state: queued, running, done, cancelled or failed.
    """

    job: str
    state: Literal["queued", "running", "done", "cancelled", "failed"]
    done: int = 0
    total: int = 0


REPLIES: dict[Verb, type[Reply]] = {  # the queries' replies are SPARQL's own
    Verb.SATISFIES: SatisfiesReply,
    Verb.CAUSES: CausesReply,
    Verb.CANPERFORM: VerdictsReply,
    Verb.CANACHIEVE: VerdictsReply,
    Verb.WHY: TextReply,
    Verb.PLACE: PlaceReply,
    Verb.WHATIF: WhatIfReply,
    Verb.TASK: TaskReply,
    Verb.COMPUTE: ComputeReply,
    Verb.SWEEP: JobReply,
    Verb.HISTORY: HistoryReply,
}
