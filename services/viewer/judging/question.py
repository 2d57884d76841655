"""What is asked of a judge and what it answers: picklable values, names as people type them."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from predicates.case import Diagnosis
from sdt_kg.iri import Iri
from sdt_kg.motion import BodyMotion, Motion
from services.app import DEFAULT_BUDGET
from services.judging.problems import Problem
from services.viewer.picture.marks import Mark
from services.why import Section

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Place:
    """The world that a question is about.

    Attributes:
        kitchen: Bundled name or path.
        robot: Bundled name or path.
        states: `CONTAINER=POSITION` texts.
        edits: Texts as `sdt branch` takes them: `box:NAME=…` and so on.
    """

    kitchen: str
    robot: str
    states: tuple[str, ...] = ()
    edits: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Question:
    """Can the robot do the task there?

    Attributes:
        task: `open:CONTAINER` or `close:CONTAINER`.
        tee: Name of the TEE class.
        drive: None: the robot's own.
        base: Start pose x, y [m], yaw [rad]; None: the kitchen's, turned to the handle.
        budget: Of the search [s].
        motion: Path of a file with the motion to be judged; empty: to be found.
        any_start: Whether a motion that is given may begin anywhere.
        friction: Coefficient with which fingers rub on handles [1]; None: the verdict says what is needed.
    """

    place: Place
    task: str
    tee: str = "D_artic"
    drive: str | None = None
    base: tuple[float, float, float] | None = None
    budget: float = DEFAULT_BUDGET
    motion: str = ""
    any_start: bool = False
    friction: float | None = None


@dataclass(frozen=True, slots=True)
class PathsAsked:
    """Which containers can be opened from the present state, no robot asked?"""

    place: Place


@dataclass(frozen=True, slots=True, eq=False)
class Opening:
    """How a container opens: SatisfiesRequest and Causes hold.

    Attributes:
        values: Of its joint, shape (T,) [rad or m].
    """

    container: str
    handle: Iri
    joint: Iri
    values: Array


@dataclass(frozen=True, slots=True)
class Paths:
    """What can be opened, and why the rest cannot: container → reason."""

    openings: tuple[Opening, ...]
    refused: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A verdict, ready to be shown.

    Attributes:
        question: What was asked.
        outcome: certified, not_certified or abstained.
        holds: The answers of SatisfiesRequest, Causes and CanPerform; None: not asked.
        sections: The verdict in plain words.
        motion: The robot's motion, else the container's, else nothing is to be played.
        marks: What is to be looked at.
        start: Base pose x, y [m], yaw [rad] from which the robot was to begin; None where nothing says so.
        seconds: That the verdict took.
        trig: The record as TriG.
    """

    question: Question
    iri: Iri
    outcome: str
    holds: tuple[bool | None, bool | None, bool | None]
    diagnoses: tuple[Diagnosis, ...]
    sections: tuple[Section, ...]
    motion: BodyMotion | Motion | None
    marks: tuple[Mark, ...]
    start: tuple[float, float, float] | None
    seconds: float
    trig: bytes = field(repr=False, default=b"")


Asked = Question | PathsAsked
Answered = Judged | Paths | Problem
"""A problem says in the words of the shell why there is no answer."""
