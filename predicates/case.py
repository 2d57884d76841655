"""Case, Answer, Diagnosis and Verdict: what the three relations are about and what they say."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from typing import Final, Never

from predicates.margins import NearestPair
from sdt_kg.display import Badge, card
from sdt_kg.errors import NoTruthError
from sdt_kg.iri import Iri, local_name
from sdt_kg.motion import BodyMotion, Motion
from sdt_kg.numbers import so_many
from sdt_kg.shacl import Violation
from sdt_kg.state import Region, State
from sdt_kg.task import UNKNOWN, Task, Unknown
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True)
class Case:
    """(R, E, Π, G, τ): each field but the twin may be unknown and is then solved for.

    Attributes:
        twin: E and G, the environment in its current state.
        robot: R; `UNKNOWN` where no robot is asked about.
        task: Π.
        motion: τ of the container.
        final: G_final: a state, or the region that the task demands.
        body_motion: Γ of the robot.
    """

    twin: Twin
    robot: Iri | Unknown = UNKNOWN
    task: Task | Unknown = UNKNOWN
    motion: Motion | Unknown = UNKNOWN
    final: State | Region | Unknown = UNKNOWN
    body_motion: BodyMotion | Unknown = UNKNOWN


class Kind(Enum):
    """Why a motion is not certified."""

    SEMANTIC = "semantic"
    CAUSAL = "causal"
    EMBODIMENT = "embodiment"
    OUT_OF_SCOPE = "out_of_scope"


class Code(Enum):
    """By what programs tell a reason from others of its kind, whatever its words."""

    NOTHING_TO_CAUSE = "nothing_to_cause"
    ROBOT_ELSEWHERE = "robot_elsewhere"
    KITCHEN_ELSEWHERE = "kitchen_elsewhere"


class Quantity(Enum):
    """What a piece of evidence measures."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    DISTANCE = "distance"
    TOOL_ERROR = "tool_error"
    ORIENTATION_ERROR = "orientation_error"
    SIDEWAYS_VELOCITY = "sideways_velocity"
    FORCE = "force"
    TIME = "time"
    COUNT = "count"
    LIMIT = "limit"
    DEMANDED_POSITION = "demanded_position"


@dataclass(frozen=True, slots=True)
class Evidence:
    """One measured quantity against its bound.

    Attributes:
        quantity: A collision is DISTANCE with a negative value (penetration).
        value: As measured, in `unit`.
        bound: What it had to keep, in `unit`; of a DEMANDED_POSITION, that at which holds are refuted.
        unit: m, rad, m/s, rad/s, m/s2, rad/s2, s, N or 1.
        entity: IRI of the joint or body concerned.
        links: IRIs of the two bodies of a distance.
        time: Along the motion [s], where it has one.
        scope: `self` or `environment` for a distance, else empty.
        path: IRI of the shape's path, for a scope violation.
    """

    quantity: Quantity
    value: float
    bound: float
    unit: str
    entity: Iri | None = None
    links: tuple[Iri, Iri] | None = None
    time: float | None = None
    scope: str = ""
    path: Iri | None = None


@dataclass(frozen=True, slots=True)
class Search:
    """What was tried before a search gave up.

    Attributes:
        seeds: Postures from which one that holds the handle was looked for.
        branches: Ways to follow the handle in hand, from those that were found.
        placements: Of these, to which a way from the start was looked for.
    """

    seeds: int = 0
    branches: int = 0
    placements: int = 0
    seconds: float = 0.0

    def __str__(self) -> str:
        """What was searched, and for how long; where nothing came so far as to be tried, that."""
        if not (self.seeds or self.branches or self.placements):
            return f"searched {self.seconds:.1f} s, and found no hold to try"
        tried = (
            so_many(self.seeds, "posture at the handle", "postures at the handle"),
            so_many(self.branches, "way to follow it", "ways to follow it"),
            so_many(self.placements, "way to come to it", "ways to come to it"),
        )
        return f"searched {', '.join(tried)} in {self.seconds:.1f} s"


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One reason for a refusal or abstention.

    Attributes:
        reason: One sentence for people, names not IRIs.
        evidence: What it rests on, None where nothing was measured.
        proof: True only where infeasibility is shown by a sound bound, not where a search gave up.
        search: What was tried, for a search that gave up.
        violation: The SHACL result, for a case out of scope.
        code: Which reason it is, where a program does something with that; nothing of its own is claimed.
    """

    kind: Kind
    reason: str
    evidence: Evidence | None = None
    proof: bool = False
    search: Search | None = None
    violation: Violation | None = None
    code: Code | None = None


class ArtefactKind(Enum):
    """What an artefact lets others re-verify."""

    CERTIFICATE = "certificate"
    PROOF = "proof"


class Artefact:
    """What an oracle hands over so that its answer can be re-verified without it.

    Args:
        kind: What that is.
        content: The bytes, or what writes them when they are first asked for: most are kept by nobody.
    """

    __slots__ = ("_content", "kind")

    def __init__(self, kind: ArtefactKind, content: bytes | Callable[[], bytes]) -> None:
        self.kind: Final = kind
        self._content = content

    @property
    def content(self) -> bytes:
        """Describes itself: JSON with its `schema`, or such a JSON compressed by zlib."""
        if not isinstance(self._content, bytes):
            self._content = self._content()
        return self._content

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Artefact) and (self.kind, self.content) == (other.kind, other.content)

    def __hash__(self) -> int:
        return hash((self.kind, self.content))

    def __reduce__(self) -> tuple[type["Artefact"], tuple[ArtefactKind, bytes]]:
        return Artefact, (self.kind, self.content)


@dataclass(frozen=True, slots=True)
class Answer:
    """One answer of a relation: a case with more known, or a refusal.

    Attributes:
        case: The case with what the relation solved for filled in.
        holds: Whether the relation holds.
        diagnoses: Why not; empty where it holds.
        notes: What a reader should know of how it was found (base policy, margins, time split).
        seconds: Name of a step → seconds spent in it.
        figures: Certified margins: name → (value, unit); empty where nothing was certified.
        artefact: What re-verifies the answer, where the oracle gives one.
        nearest_pairs: Name of a figure → between which bodies that distance is; none of one that is a bound.
    """

    case: Case
    holds: bool
    diagnoses: tuple[Diagnosis, ...] = ()
    notes: tuple[str, ...] = ()
    seconds: dict[str, float] = field(default_factory=dict[str, float])
    figures: dict[str, tuple[float, str]] = field(default_factory=dict[str, tuple[float, str]])
    artefact: Artefact | None = None
    nearest_pairs: dict[str, NearestPair] = field(default_factory=dict[str, NearestPair])

    def __bool__(self) -> bool:
        """Whether the relation holds."""
        return self.holds


class Outcome(Enum):
    """What the Law says."""

    CERTIFIED = "certified"
    NOT_CERTIFIED = "not_certified"
    ABSTAINED = "abstained"


OUTCOME_OF: Final = "compare its outcome: verdict.outcome is Outcome.CERTIFIED (predicates.case), say"
"""What to do in place of taking a verdict for true or false."""

UNKNOWN_INPUT = "unknown"
"""What the inputs of a verdict say of what was to be solved for."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """CanAchieve.

    Attributes:
        iri: Hash of all inputs (ARCHITECTURE, decision 8).
        case: With everything that the relations solved for.
        satisfies_request: None where the relation was not run.
        causes: None where the relation was not run.
        can_perform: None where the relation was not run.
        inputs: Name → value or hash of each input, in the order in which they are hashed.
        stored: Whether it was judged before, and answers again because it was kept.
    """

    iri: Iri
    outcome: Outcome
    case: Case
    satisfies_request: Answer | None
    causes: Answer | None
    can_perform: Answer | None
    diagnoses: tuple[Diagnosis, ...]
    inputs: tuple[tuple[str, str], ...]
    seconds: float
    stored: bool = False

    def __bool__(self) -> Never:
        """Of three outcomes two are no *yes*, and one of these is no *no* either."""
        raise NoTruthError("a verdict", OUTCOME_OF)

    def __str__(self) -> str:
        """The outcome, the question and every reason, for people."""
        said = f"{self.outcome.value.replace('_', ' ')}: {self._question()}"
        return "\n".join((said, *(f"  {name}: {reason}" for name, reason in self._reasons())))

    def _repr_html_(self) -> str:
        """The question, the outcome, each predicate's answer and every reason, for Jupyter."""
        answers = (self.satisfies_request, self.causes, self.can_perform)
        rows = [
            (name, "not asked" if each is None else "yes" if each.holds else "no")
            for name, each in zip(("SatisfiesRequest", "Causes", "CanPerform"), answers, strict=True)
        ]
        rows += [*self._reasons(), ("IRI", self.iri)]
        badge = Badge.BAD if any(each.proof for each in self.diagnoses) else _BADGES[self.outcome]
        return card(self._question(), rows, (self.outcome.value.replace("_", " "), badge))

    @property
    def is_of_given_motion(self) -> bool:
        """Whether a motion was given to be verified: of another one, what is proved says nothing."""
        inputs = dict(self.inputs)
        return any(inputs.get(each, UNKNOWN_INPUT) != UNKNOWN_INPUT for each in ("motion", "body_motion"))

    def _question(self) -> str:
        """Who, what, where."""
        task, robot = self.case.task, self.case.robot
        about = [local_name(robot)] if isinstance(robot, str) else []
        about += [str(task)] if isinstance(task, Task) else []
        return f"{', '.join(about) or 'a motion'} in kitchen {local_name(self.case.twin.environment)}"

    def _reasons(self) -> Iterator[tuple[str, str]]:
        """Kind and reason of each diagnosis, and how sure it is."""
        proved = " (proved of the motion that was given)" if self.is_of_given_motion else " (proved)"
        for each in self.diagnoses:
            sure = proved if each.proof else " (not proved: a search gave up)" if each.search else ""
            yield each.kind.value.replace("_", " "), each.reason + sure


_BADGES = {Outcome.CERTIFIED: Badge.GOOD, Outcome.NOT_CERTIFIED: Badge.WARN, Outcome.ABSTAINED: Badge.NONE}
