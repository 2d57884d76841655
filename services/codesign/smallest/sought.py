"""What is asked of a smallest change, and what each family of edits gave."""

from dataclasses import dataclass
from functools import lru_cache

from predicates.case import Outcome
from predicates.counterfactual import turns, widest_gap
from services.app import Policy, load
from services.codesign.entries import Found
from services.codesign.smallest.families import Family
from services.relative import KINEMATIC, Relative
from services.whatif import World


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked, in a form that travels between processes."""

    kitchen: str
    robot: str
    task: str
    states: tuple[str, ...]
    policy: Policy
    relative: Relative = KINEMATIC


@dataclass(frozen=True, slots=True)
class Trial:
    """An edit that was tried, and what came of it.

    Attributes:
        turns: Whether the outcome is then another one.
        direction: Of gradual edits: which of the family's.
        share: Of gradual edits: how much of the longest way; 0: nothing was changed.
    """

    edit: str
    found: Found
    turns: bool = False
    direction: int = 0
    share: float = 1.0

    @property
    def is_proved(self) -> bool:
        """Whether its outcome is a refusal by proof."""
        return self.found.outcome is Outcome.NOT_CERTIFIED and self.found.is_proved


def trial(edit: str, found: Found, actual: Found, direction: int = 0, share: float = 1.0) -> Trial:
    """What came of an edit; where there is no such world, nothing turned."""
    is_world = found.outcome is not None
    return Trial(edit, found, is_world and turns(actual, found), direction, share)


@dataclass(frozen=True, slots=True)
class Sought:
    """What one family gave.

    Attributes:
        trials: Everything that was judged, in order; of gradual edits also the world as it is, at share 0.
        stopped: Whether the time ended before the family did.
        spent: CPU time of its process on the search until then [s].
        impossible: Why the family's edits cannot be made here; empty where they can.
    """

    family: Family
    trials: tuple[Trial, ...] = ()
    stopped: bool = False
    spent: float = 0.0
    impossible: str = ""

    @property
    def tried(self) -> tuple[Trial, ...]:
        """Edits that were judged, in order."""
        return tuple(each for each in self.trials if each.share > 0)

    @property
    def turn(self) -> Trial | None:
        """The smallest edit that turns the outcome, of whole ones the first; None: none was found."""
        return min((each for each in self.trials if each.turns), key=lambda each: each.share, default=None)

    @property
    def not_yet(self) -> Trial | None:
        """Of a gradual edit the next smaller one that was tried, and turns nothing; None: a whole one."""
        turn = self.turn
        if turn is None or not self.family.scan:
            return None
        own = [each for each in self.trials if each.direction == turn.direction and each.share < turn.share]
        return max(own, key=lambda each: each.share, default=None)

    @property
    def reach(self) -> float:
        """[1] Share up to which gradual edits count: of the smallest that turns, else of the longest way."""
        return 1.0 if self.turn is None else self.turn.share

    @property
    def smaller(self) -> tuple[Trial, ...]:
        """Gradual edits that were tried and are smaller than the one that turns; all, where none does."""
        turned = self.turn is not None
        return tuple(each for each in self.tried if each.share < self.reach or not turned)

    @property
    def gap(self) -> float:
        """[m] How far neighbours among the gradual edits that count are apart at most, in any direction."""
        return max((self._gap(direction) for direction, _ in enumerate(self.family.lengths)), default=0.0)

    @property
    def own_gap(self) -> float:
        """[m] The same in the direction of the smallest that turns, if one does."""
        return self.gap if self.turn is None else self._gap(self.turn.direction)

    def _gap(self, direction: int) -> float:
        longest = self.family.longest
        shares = [each.share for each in self.trials if each.direction == direction]
        return longest * widest_gap(shares, min(self.reach, self.family.lengths[direction] / longest))

    @property
    def is_complete(self) -> bool:
        """Whether everything was tried: every whole edit, or gradual ones as finely as they are told."""
        if self.family.scan:
            return bool(self.trials) and self.gap <= self.family.finest
        return not self.stopped and bool(self.trials)

    @property
    def is_proved(self) -> bool:
        """Whether no edit of the family turns the outcome: each was tried, and refused by a proof."""
        every = not self.family.scan and self.is_complete
        return every and self.turn is None and all(each.is_proved for each in self.tried)


@dataclass(frozen=True, slots=True)
class Turned:
    """The verdict as it is, and the smallest change of each family.

    Attributes:
        seconds: Wall time [s].
        cpu_seconds: CPU time of this process and its workers [s].
    """

    question: Question
    actual: Found
    sought: tuple[Sought, ...]
    seconds: float
    cpu_seconds: float


@lru_cache(maxsize=2)
def world_of(question: Question) -> World:
    """Loaded once; processes that begin as copies of this one have it."""
    service = load(question.kitchen, [question.robot], state=question.states, policy=question.policy)
    return World(question.relative.of(service), question.robot)


def ground_of(question: Question, each: float, family: Family | None = None) -> World:
    """The world as it is, from where the family's gradual edits begin, with so much search [s] in each."""
    world = world_of(question).under(budget=min(question.policy.budget, each))
    return world if family is None or family.start is None else world.under(base=family.start)
