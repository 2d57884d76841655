"""A sequence step by step: what each asks where the last one ended, and what all of them add up to."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from predicates.case import Diagnosis, Kind, Outcome
from predicates.satisfies_request import met_requests
from predicates.specification.leg import Leg
from predicates.specification.model import Specification, Step
from predicates.specification.rules import Standing
from predicates.specification.step import Request
from sdt_kg.state import State
from sdt_kg.twin import Twin


@dataclass(frozen=True, slots=True)
class Taken:
    """What became of one request.

    Attributes:
        outcome: Of its verdict.
        leg: What its motion does to the kitchen; None where it is not certified, so that nothing follows.
        final: The state in which the motion ends; None likewise.
        drifts: Whether the container may move when it is let go, so that `final` is not where it stays.
        restless: Whether another, which nobody holds, may move meanwhile.
    """

    outcome: Outcome
    leg: Leg | None = None
    final: State | None = None
    drifts: bool = False
    restless: bool = False


class Walk:
    """The steps of a specification on their way.

    Args:
        twin: Kitchen and robot in the state in which the first step begins.
        specification: About that kitchen.

    Attributes:
        twin: In the state in which the last step that is certified ended.
        legs: Of the steps that are certified.
        expected: How many requests there are, as far as was found on the way.
        reasons: Why it is not certified, or nothing is claimed, though each step may be certified.
    """

    def __init__(self, twin: Twin, specification: Specification) -> None:
        self.twin, self.specification = twin, specification
        self.legs: list[Leg] = []
        self.expected = 0
        self._outcomes: list[Outcome] = []
        self._adrift: Request | None = None
        self._restless: Request | None = None
        self._undone: list[Diagnosis] = []
        self._unsure: list[Diagnosis] = []

    @property
    def reasons(self) -> tuple[Diagnosis, ...]:
        """What was undone, and what is not known."""
        return *self._undone, *self._unsure

    @property
    def complete(self) -> bool:
        """Whether every request was taken, and is certified."""
        return len(self.legs) == len(self._outcomes) == self.expected

    @property
    def _stopped(self) -> bool:
        """Whether what was judged last is not certified, so that no other step can follow."""
        return len(self.legs) < len(self._outcomes) or bool(self._undone or self._unsure)

    def go(self, take: Callable[[Request], Taken], told: Callable[[int], None] = lambda asked: None) -> None:
        """Take the requests one by one, until one is not certified.

        Args:
            take: What becomes of a request in the state of `twin`.
            told: Is called after each, with how many there are as far as is known.
        """
        steps = self.specification.steps
        for number, step in enumerate(steps, 1):
            requests = _requests(self.twin, step)
            self.expected += len(requests)
            for request in requests:
                if step.container is None and _meets(self.twin, request):
                    self.expected -= 1  # what moves together did it on the way
                elif self._may_take(request):
                    self._take(request, take)
                    told(self.expected + len(steps) - number)
            self._look_back(step)
            if self._stopped:
                self.expected += len(steps) - number
                break
        if self.complete and self.specification.rules:
            self._unsure += self._unbounded()

    def _unbounded(self) -> Iterator[Diagnosis]:
        """Why rules may be about what is not where the motions have it."""
        if self._adrift is not None:
            yield _drifts(self._adrift, "nothing bounds what the rules are about from then on")
        if self._restless is not None:
            reason = (
                f"a container that nobody holds may move by itself in '{self._restless}', as its verdict "
                "says, so that nothing bounds what the rules are about"
            )
            yield Diagnosis(Kind.OUT_OF_SCOPE, reason)

    def outcome(self, standings: Iterable[Standing]) -> Outcome:
        """What the steps, and the rules that stand so, add up to."""
        rules, verdicts = set(standings), set(self._outcomes)
        if not verdicts or self._undone:
            return Outcome.NOT_CERTIFIED
        if Standing.BROKEN in rules or Outcome.NOT_CERTIFIED in verdicts:
            return Outcome.NOT_CERTIFIED
        if not self.complete or self._unsure or verdicts != {Outcome.CERTIFIED}:
            return Outcome.ABSTAINED
        return Outcome.CERTIFIED if rules <= {Standing.KEPT} else Outcome.ABSTAINED

    def _may_take(self, request: Request) -> bool:
        """Whether one more can be judged: it is known where the last one has left the kitchen."""
        if self._adrift is not None and not self._stopped:
            self._unsure.append(_drifts(self._adrift, f"nobody knows where '{request}' begins"))
        return not self._stopped

    def _take(self, request: Request, take: Callable[[Request], Taken]) -> None:
        taken = take(request)
        self._outcomes.append(taken.outcome)
        if taken.leg is None or taken.final is None:
            return
        self.legs.append(taken.leg)
        self.twin = self.twin.at(taken.final)
        self._adrift = request if taken.drifts else None
        if taken.restless and self._restless is None:
            self._restless = request

    def _look_back(self, step: Step) -> None:
        """See what of a step for every container is undone at its end, by what moves together."""
        if step.container is not None or self._stopped:
            return
        for each in _requests(self.twin, step):
            reason = (
                f"'{each}' is not so at the end of the step for every container: what moves with it undid it"
            )
            self._undone.append(Diagnosis(Kind.SEMANTIC, reason))


def _requests(twin: Twin, step: Step) -> list[Request]:
    """What a step asks in a state: every container means those that do not meet the request yet."""
    if step.container is not None:
        return [Request(step.verb, step.container, step.position)]
    every = (Request(step.verb, each) for each in twin.containers())
    return [each for each in every if not _meets(twin, each)]


def _meets(twin: Twin, request: Request) -> bool:
    """Whether the state meets a request that every container is asked."""
    return (request.verb, request.container.iri) in met_requests(twin, twin.state)


def _drifts(request: Request, so: str) -> Diagnosis:
    reason = f"{request.container.name} may move when it is let go after '{request}', so that {so}"
    return Diagnosis(Kind.OUT_OF_SCOPE, reason)
