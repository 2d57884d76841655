"""The first look at a family of edits: each whole one, or a few sizes of gradual ones and then halves."""

from dataclasses import replace
from functools import partial

from predicates.counterfactual import Tried, nearest_turns
from sdt_kg.errors import InputError
from services.codesign.again import whole_body
from services.codesign.entries import Found
from services.codesign.smallest.deadline import Deadline
from services.codesign.smallest.families import Family, base_family, made_at_once
from services.codesign.smallest.sought import Question, Sought, Trial, ground_of, trial
from services.embodiment.place import spots
from services.requests import parse_task
from services.whatif import Change, World, changed

Start = tuple[float, float, float]

PLACING = 4.0
"""[s] Of CPU for base poses towards which the start is moved."""
SPOTS = 2
"""[1] Base poses towards which the start is moved: the nearest."""


def looked(question: Question, actual: Found, deadline: Deadline, family: Family | None) -> Sought:
    """What one family gives, and what its process had spent by then; None: base poses, to be found first."""
    return replace(_given(question, actual, deadline, family), spent=deadline.spent())


def _given(question: Question, actual: Found, deadline: Deadline, family: Family | None) -> Sought:
    if family is None:
        family = _starts(question, deadline)
        if not family.edits:
            return Sought(family, stopped=deadline.is_late())
    world = ground_of(question, deadline.each, family)
    try:
        search = _gradual if family.scan else whole
        return search(world, question.task, actual, deadline, family)
    except InputError as error:
        return Sought(family, impossible=str(error))


def whole(world: World, task: str, actual: Found, deadline: Deadline, family: Family) -> Sought:
    """Each edit, until one turns the outcome."""
    tried: list[Trial] = []
    for text in family.edits:
        if deadline.is_late():
            return Sought(family, tuple(tried), stopped=True)
        try:
            made = partial(changed, world, made_at_once(text))
            tried.append(trial(text, deadline.judged(world, actual, made, task), actual))
        except InputError:  # this robot has no such gripper, that joint stands there already
            continue
        if tried[-1].turns:
            return Sought(family, tuple(tried))
    return Sought(family, tuple(tried), impossible="" if tried else "none of its edits can be made here")


def _gradual(world: World, task: str, actual: Found, deadline: Deadline, family: Family) -> Sought:
    """A few sizes in all directions, and halves below the first that turns."""
    changes = family.directions
    judges = [partial(at, world, task, actual, deadline, change) for change in changes]
    found = nearest_turns(judges, actual, family.scan, family.tolerance, deadline.is_late)
    trials = [
        sized(world, change, actual, direction, each)
        for direction, (change, turn) in enumerate(zip(changes, found, strict=True))
        for each in turn.tried
    ]
    return Sought(family, tuple(trials), stopped=deadline.is_late())


def sized(world: World, change: Change, actual: Found, direction: int, tried: Tried[Found]) -> Trial:
    """What came of a share of a gradual edit."""
    assert change.amount is not None, "of gradual edits there is less"
    return trial(change.amount(world, tried.share), tried.verdict, actual, direction, tried.share)


def at(  # noqa: PLR0913, PLR0917 - who is asked what, and how long it may take
    world: World, task: str, actual: Found, deadline: Deadline, change: Change, share: float
) -> Found:
    """The outcome after a share of a gradual edit."""
    return deadline.judged(world, actual, partial(change.at, world, share), task)


def _starts(question: Question, deadline: Deadline) -> Family:
    """From where the robot starts towards the nearest poses of a base that stands still and is certified."""
    ground = ground_of(question, deadline.each)
    service = ground.service
    start = whole_body(service).start_pose(service.case(question.task, ground.robot_iri))
    if deadline.is_late():
        return base_family(start, [])
    left = min(PLACING, deadline.left - deadline.spent())
    asked = parse_task(service.twin, question.task)
    how = {"seed": service.policy.seed, "friction": service.policy.friction}
    found = spots(service.twin, ground.robot_iri, asked, left, enough=SPOTS, **how)
    poses = ((each.x, each.y, each.yaw) for each in found)
    return base_family(start, sorted(poses, key=partial(_squared_way, start))[:SPOTS])


def _squared_way(start: Start, pose: Start) -> float:
    return (pose[0] - start[0]) ** 2 + (pose[1] - start[1]) ** 2
