"""The smallest change that turns a verdict where nobody names one: every family of edits, within a time."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

from predicates.counterfactual import Tried, Turn, nearest_turns, turns
from sdt_kg.errors import InputError
from sdt_kg.scope import D_ARTIC
from sdt_kg.task import Task
from sdt_kg.twin import Container
from services.app import Policy, load
from services.codesign.again import whole_body
from services.codesign.deadline import Deadline
from services.codesign.entries import Found, How, found_of
from services.codesign.families import Family, base_family, families, made_at_once, pairs
from services.codesign.judge import one_of
from services.embodiment.place import place
from services.relative import in_class
from services.requests import parse_task
from services.sweep.engines import cpu_seconds
from services.sweep.handed import each as each_done
from services.whatif import Change, World, changed

Start = tuple[float, float, float]

EACH = 0.05
"""[1] Of the time for the search in each edited world: what was refused so was searched, no more."""
PLACING = 4.0
"""[s] Of CPU for base poses towards which the start is moved."""
LONGEST = 1000
"""[1] More than any family has edits."""
SPOTS = 2
"""[1] Base poses towards which the start is moved: the nearest."""
FOR_ACTUAL = 0.3
"""[1] Of the time at most for the verdict as it is."""


@dataclass(frozen=True, slots=True)
class Question:
    """What is asked, in a form that travels between processes."""

    kitchen: str
    robot: str
    task: str
    states: tuple[str, ...]
    policy: Policy
    tee: str = D_ARTIC.name
    forces: Path | None = None


@dataclass(frozen=True, slots=True)
class Trial:
    """An edit that was tried, and what came of it."""

    edit: str
    found: Found


@dataclass(frozen=True, slots=True)
class Sought:
    """What one family gave.

    Attributes:
        turn: The smallest edit that turns the outcome; None: none was found.
        not_yet: The edit before it, which does not; None: it is a whole one.
        tried: Everything that was judged, in order.
        stopped: Whether the time ended before the family did.
        spent: CPU time of its process on the search until then [s].
        impossible: Why the family's edits cannot be made here; empty where they can.
    """

    family: Family
    turn: Trial | None = None
    not_yet: Trial | None = None
    tried: tuple[Trial, ...] = ()
    stopped: bool = False
    spent: float = 0.0
    impossible: str = ""

    @property
    def is_proved(self) -> bool:
        """Whether no edit of the family turns the outcome: each was tried, and refused by a proof."""
        every = not self.family.scan and not self.stopped and bool(self.tried)
        return every and self.turn is None and all(each.found.is_proved for each in self.tried)


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


def turned(question: Question, within: float, jobs: int) -> Turned:
    """The smallest change of each family that turns the verdict.

    Args:
        question: What is asked.
        within: Seconds of CPU for each process; on an idle machine the search takes as long.
        jobs: Processes.

    Raises:
        InputError: The task is about more than one container, or something has no such name.
    """
    began, cpu_began = time.time(), cpu_seconds()
    whole = Deadline(within, EACH * within, f"{began} as it is")
    whole.spent()
    world = _world(question)
    container = container_asked(world, question.task)
    ground = world.under(budget=min(question.policy.budget, FOR_ACTUAL * within))
    verdict = one_of(ground.service.achieve(question.task, world.robot_iri))
    actual = found_of(verdict, How.LAW, verdict.seconds)
    work, single = partial(_sought, question, actual), families(world, verdict, container)
    deadline = Deadline(within - whole.spent(), EACH * within, f"{began} one change")
    sought = _all(partial(work, deadline), [*single, None], jobs)
    if all(each.turn is None for each in sought):
        left = deadline.left - max(each.spent for each in sought)
        deadline = Deadline(left, EACH * within, f"{began} two changes")
        sought.append(_together(partial(work, deadline), pairs(single), jobs))
    told = tuple(each for each in sought if each.family.edits or each.stopped)
    return Turned(question, actual, told, time.time() - began, cpu_seconds() - cpu_began)


def container_asked(world: World, text: str) -> Container:
    """The one container of the task.

    Raises:
        InputError: It is about none, or about several.
    """
    task: Task = parse_task(world.service.twin, text)
    if not isinstance(task.container, str):
        raise InputError(f"'{text}' is several questions", allowed="one container, open:CONTAINER say")
    return world.service.twin.container(task.container)


def _all(work: Callable[[Family | None], Sought], todo: list[Family | None], jobs: int) -> list[Sought]:
    """In the order of the families, whichever is done first."""
    done = {
        family and family.name: found for family, found in each_done(sorted(todo, key=_begun), jobs, work)
    }
    return [done[family and family.name] for family in todo]


def _begun(family: Family | None) -> tuple[bool, int]:
    """When a family is begun: whole edits, which are few, then base poses, then the longest first."""
    if family is None:
        return True, -LONGEST
    return family.scan > 0, -len(family.edits) * family.scan


def _together(work: Callable[[Family | None], Sought], family: Family, jobs: int) -> Sought:
    """Every process takes some of the pairs; the first in their order that turns the outcome counts."""
    parts = [
        replace(family, name=f"{family.name} {k}", edits=family.edits[k::jobs])
        for k in range(min(jobs, len(family.edits)))
    ]
    found = _all(work, [*parts], jobs)
    turning = [each.turn for each in found if each.turn is not None]
    first = min(turning, key=lambda each: family.edits.index(each.edit), default=None)
    tried = sorted((t for each in found for t in each.tried), key=lambda t: family.edits.index(t.edit))
    return Sought(family, first, tried=tuple(tried), stopped=any(each.stopped for each in found))


@lru_cache(maxsize=2)
def _world(question: Question) -> World:
    """Loaded once; processes that begin as copies of this one have it."""
    service = load(question.kitchen, [question.robot], state=question.states, policy=question.policy)
    return World(in_class(service, question.tee, question.forces), question.robot)


def _sought(question: Question, actual: Found, deadline: Deadline, family: Family | None) -> Sought:
    """What one family gives, and what its process had spent by then."""
    return replace(_given(question, actual, deadline, family), spent=deadline.spent())


def _given(question: Question, actual: Found, deadline: Deadline, family: Family | None) -> Sought:
    """What one family gives; None stands for base poses, which have to be found first."""
    ground = _world(question).under(budget=min(question.policy.budget, deadline.each))
    if family is None:
        start = _start(ground, question.task)
        ground = ground.under(base=start)
        family = base_family(start, _spots(ground, question.task, start, deadline))
        if not family.edits:
            return Sought(family, stopped=deadline.is_late())
    try:
        search = _gradual if family.scan else _whole
        return search(ground, question.task, actual, deadline, family)
    except InputError as error:
        return Sought(family, impossible=str(error))


def _whole(world: World, task: str, actual: Found, deadline: Deadline, family: Family) -> Sought:
    """Each edit, until one turns the outcome."""
    tried: list[Trial] = []
    for text in family.edits:
        if deadline.is_late():
            return Sought(family, tried=tuple(tried), stopped=True)
        try:
            made = partial(changed, world, made_at_once(text))
            tried.append(Trial(text, deadline.judged(made, task)))
        except InputError:  # this robot has no such gripper, that joint stands there already
            continue
        if turns(actual, tried[-1].found):
            return Sought(family, tried[-1], tried=tuple(tried))
    return Sought(
        family, tried=tuple(tried), impossible="" if tried else "none of its edits can be made here"
    )


def _gradual(world: World, task: str, actual: Found, deadline: Deadline, family: Family) -> Sought:
    """The smallest share over all directions."""
    changes = family.directions
    judges = [partial(_at, world, task, change, deadline) for change in changes]
    turns = nearest_turns(judges, actual, family.scan, family.tolerance, deadline.is_late)
    tried = [_trials(world, change, turn) for change, turn in zip(changes, turns, strict=True)]
    listed = tuple(trial for own in tried for _, trial in own)
    found = [(turn.after.share, k) for k, turn in enumerate(turns) if turn.after is not None]
    stopped = deadline.is_late()
    if not found:
        return Sought(family, tried=listed, stopped=stopped)
    _, best = min(found)
    own = tried[best]
    first = next(n for n, (share, _) in enumerate(own) if share == min(found)[0])
    not_yet = own[first - 1][1] if first else Trial(_amount(world, changes[best], 0.0), actual)
    return Sought(family, own[first][1], not_yet, listed, stopped)


def _trials(world: World, change: Change, turn: Turn[Found]) -> list[tuple[float, Trial]]:
    """Share and trial of all that was tried in one direction, but for nothing of the change."""
    tried: tuple[Tried[Found], ...] = turn.tried
    return [
        (each.share, Trial(_amount(world, change, each.share), each.verdict))
        for each in tried
        if each.share > 0
    ]


def _amount(world: World, change: Change, share: float) -> str:
    assert change.amount is not None, "of gradual edits there is less"
    return change.amount(world, share)


def _at(world: World, task: str, change: Change, deadline: Deadline, share: float) -> Found:
    return deadline.judged(partial(change.at, world, share), task)


def _start(world: World, task: str) -> Start:
    service = world.service
    return whole_body(service).start_pose(service.case(task, world.robot_iri))


def _spots(world: World, task: str, start: Start, deadline: Deadline) -> list[Start]:
    """The nearest base poses from which a base that stands still is certified."""
    if deadline.is_late():
        return []
    service, left = world.service, min(PLACING, deadline.left - deadline.spent())
    asked = parse_task(service.twin, task)
    found = place(service.twin, world.robot_iri, asked, budget=left, seed=service.policy.seed, enough=SPOTS)
    spots = ((each.x, each.y, each.yaw) for each in found.spots)
    return sorted(spots, key=lambda spot: (spot[0] - start[0]) ** 2 + (spot[1] - start[1]) ** 2)[:SPOTS]
