"""Smaller sizes of gradual edits, on finer and finer grids: outcomes turn and turn back between the first."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

from predicates.counterfactual import Tried, between
from sdt_kg.errors import InputError
from services.codesign.entries import Found, no_world
from services.codesign.smallest.coarse import at, sized
from services.codesign.smallest.deadline import Deadline
from services.codesign.smallest.families import Family
from services.codesign.smallest.sought import Question, Sought, Trial, ground_of
from services.sweep.executors.handed import each as each_done


@dataclass(frozen=True, slots=True)
class Line:
    """Sizes that are to be tried in one direction, the smallest first.

    Attributes:
        number: Of the family among those that are looked at.
    """

    number: int
    family: Family
    direction: int
    shares: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Walked:
    """What came of a line, and what its process had spent by then [s]."""

    trials: tuple[Trial, ...]
    stopped: bool
    spent: float


Walk = Callable[[Deadline, Line], Walked]


def finer(sought: Sequence[Sought], walk: Walk, deadline: Deadline, jobs: int) -> tuple[list[Sought], float]:
    """The families with smaller sizes tried too, and the most time that a process spent on them [s].

    In each round the steps are half of those before, in every family as far as its finest. First all rounds
    in the directions in which a size has turned, then everywhere; where one turns there is nothing to look
    for beyond.

    Args:
        sought: What the first look gave.
        walk: Tries the sizes of a line, see `walked`.
        deadline: Of all rounds together.
        jobs: Processes.
    """
    found, spent = list(sought), 0.0
    rounds = range(1, 1 + max((_rounds(each.family) for each in found), default=0))
    for everywhere, number in product((False, True), rounds):
        lines = _lines(found, 0.5**number, everywhere=everywhere)
        name = f"{deadline.search}, finer {number}" + " everywhere" * everywhere
        own = replace(deadline, left=deadline.left - spent, search=name)
        longest = 0.0
        for line, done in each_done(lines, jobs, partial(walk, own)):
            one = found[line.number]
            trials = (*one.trials, *done.trials)
            found[line.number] = replace(one, trials=trials, stopped=one.stopped or done.stopped)
            longest = max(longest, done.spent)
        spent += longest
        if spent + deadline.each > deadline.left:
            break
    return found, spent


def _rounds(family: Family) -> int:
    """How often the first steps of a family are halved."""
    rounds, step = 0, family.scan and family.longest / family.scan
    while step > family.finest:
        rounds, step = rounds + 1, step / 2
    return rounds


def _lines(found: Sequence[Sought], halved: float, *, everywhere: bool) -> list[Line]:
    """What is next: where a size has turned, and everywhere then beside it, then in other families."""
    lines = [
        Line(number, each.family, direction, shares)
        for number, each in enumerate(found)
        if each.family.scan and not each.impossible and not each.is_complete
        for direction, length in enumerate(each.family.lengths)
        if everywhere or _is_turned(each, direction)
        if (shares := _shares(each, direction, length / each.family.longest, halved))
    ]
    return sorted(lines, key=lambda line: (found[line.number].turn is None, len(line.shares)))


def _is_turned(one: Sought, direction: int) -> bool:
    return one.turn is not None and one.turn.direction == direction


def _shares(one: Sought, direction: int, end: float, halved: float) -> tuple[float, ...]:
    known = [each.share for each in one.trials if each.direction == direction]
    return tuple(between(known, min(one.reach, end), halved / one.family.scan))


def walked(question: Question, actual: Found, deadline: Deadline, line: Line) -> Walked:
    """Each size, until one turns the outcome."""
    world = ground_of(question, deadline.each, line.family)
    change = line.family.directions[line.direction]
    trials: list[Trial] = []
    for share in line.shares:
        if deadline.is_late():
            return Walked(tuple(trials), True, deadline.spent())
        try:
            judged = at(world, question.task, actual, deadline, change, share)
        except InputError as error:
            judged = no_world(error)
        trials.append(sized(world, change, actual, line.direction, Tried(share, judged)))
        if trials[-1].turns:
            break
    return Walked(tuple(trials), False, deadline.spent())
