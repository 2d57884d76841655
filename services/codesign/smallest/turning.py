"""The smallest change that turns a verdict where nobody names one: every family of edits, within a time."""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from predicates.record import to_record
from sdt_kg.errors import InputError
from sdt_kg.task import Task
from sdt_kg.twin import Container
from services.codesign.entries import How, found_of
from services.codesign.judge import one_of
from services.codesign.smallest.coarse import looked
from services.codesign.smallest.deadline import Deadline
from services.codesign.smallest.families import Family, families, pairs
from services.codesign.smallest.finer import finer, walked
from services.codesign.smallest.sought import Question, Sought, Turned, world_of
from services.requests import parse_task
from services.sweep.executors.engines import cpu_seconds
from services.sweep.executors.handed import each as each_done
from services.whatif import World

EACH = 0.05
"""[1] Of the time for the search in each edited world: what was refused so was searched, no more."""
TWICE = 2.0
"""[1] Of what the world as it is took, if it is certified: a refusal after less says little."""
LONGEST = 1000
"""[1] More than any family has edits."""
FOR_ACTUAL = 0.3
"""[1] Of the time at most for the verdict as it is."""
BEFORE_PAIRS = 0.5
"""[1] Of the time that is left for smaller sizes, where no single change has turned the outcome so far."""


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
    first = Deadline(within, EACH * within, f"{began} as it is")
    first.spent()
    world = world_of(question)
    container = container_asked(world, question.task)
    ground = world.under(budget=min(question.policy.budget, FOR_ACTUAL * within))
    loaded = first.spent()
    verdict = one_of(ground.service.achieve(question.task, world.robot_iri))
    actual = found_of(verdict, How.LAW, verdict.seconds)
    single = families(world, verdict, container)
    took = first.spent() - loaded if actual.is_certified else 0.0
    search, left = max(first.each, TWICE * took), within - first.spent()
    deadline = replace(first, left=left, each=search, search=f"{began} one change")
    sought = _all(partial(looked, question, actual, deadline), [*single, None], jobs)
    left = deadline.left - max(each.spent for each in sought)
    is_turned = any(each.turn is not None for each in sought)
    deadline = replace(deadline, left=left * (1.0 if is_turned else BEFORE_PAIRS))
    sought, spent = finer(sought, partial(walked, question, actual), deadline, jobs)
    if all(each.turn is None for each in sought):
        deadline = replace(deadline, left=left - spent, search=f"{began} two changes")
        sought.append(_together(partial(looked, question, actual, deadline), pairs(single), jobs))
    told = tuple(each for each in sought if each.family.edits or each.stopped)
    actual = replace(actual, record=to_record(verdict))
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
    trials = sorted((t for each in found for t in each.trials), key=lambda t: family.edits.index(t.edit))
    return Sought(family, tuple(trials), stopped=any(each.stopped for each in found))
