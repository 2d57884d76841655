"""What a grid is about: kitchens, robots, containers, and worlds as combinations of alternatives."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

from sdt_kg.errors import InputError
from services.policy import Policy
from services.relative import KINEMATIC, Relative
from services.whatif import Change, parse_change

Parse = Callable[[str], Change]
"""The change that a text means."""

TASKS: Final = "open, close, open:CONTAINER,CONTAINER"
BAR: Final = " | "
"""Between the alternatives of one axis."""
MOST_CASES: Final = 1000
"""[1] Of a grid that is asked from elsewhere, those of the world as it is among them: it is one answer."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What a grid is about.

    Attributes:
        kitchens, robots: Bundled names or paths.
        verb: `open` or `close`.
        worlds: Combinations of edits, each a world; the world as it is is not among them.
        states: Start state, see `parse_state`; a joint's state is that of the kitchens that have it.
        containers: By name; empty: all.
        relative: The class that verdicts are relative to.
        parse: What edits mean.
    """

    kitchens: tuple[str, ...]
    robots: tuple[str, ...]
    verb: str
    worlds: tuple[tuple[str, ...], ...]
    policy: Policy
    states: tuple[str, ...] = ()
    containers: tuple[str, ...] = ()
    relative: Relative = KINEMATIC
    parse: Parse = parse_change


def alternatives(axis: str) -> tuple[str, ...]:
    """Those of one axis, as they are written."""
    return tuple(each.strip() for each in axis.split(BAR.strip()))


def worlds_of(axes: Sequence[str], parse: Parse = parse_change) -> tuple[tuple[str, ...], ...]:
    """Every choice of one alternative, or of nothing, on each axis; but not of nothing on all of them.

    Raises:
        InputError: An axis has no edit, or one that is none.
    """
    choices: list[tuple[str, ...]] = []
    for axis in axes:
        each_one = alternatives(axis)
        for each in each_one:
            parse(each)
        if len(set(each_one)) < len(each_one):
            raise InputError(f"'{axis}' has an edit twice", allowed=f"different edits, with '{BAR}' between")
        choices.append(("", *each_one))
    made = (tuple(filter(None, each)) for each in product(*choices))
    return tuple(each for each in made if each)


def task_of_grid(task: str) -> tuple[str, tuple[str, ...]]:
    """Verb, and names of the containers, of `open`, `close` or `open:CONTAINER,CONTAINER`; no name: all.

    Raises:
        InputError: No such verb, or a name that is missing.
    """
    verb, colon, rest = task.partition(":")
    if verb not in {"open", "close"}:
        raise InputError(f"no task type '{verb}'", allowed=TASKS)
    names = tuple(each.strip() for each in rest.split(",")) if colon else ()
    if not all(names):
        raise InputError(f"'{task}' names no container", allowed=TASKS)
    return verb, names


def check_size(axes: Sequence[str], each: int) -> None:
    """A grid that somebody elsewhere asks for has no more cases than one answer may have.

    Args:
        axes: Alternatives of each.
        each: Cases in one world [1].

    Raises:
        InputError: It has more; said before any world is made.
    """
    cases = each * math.prod(1 + len(alternatives(axis)) for axis in axes)
    if cases > MOST_CASES:
        raise InputError(
            f"{cases} cases in a grid",
            allowed=f"{MOST_CASES}: worlds, that as it is among them, times robots times containers",
            remedy="fewer alternatives, one robot, open:CONTAINER; or sdt whatif --grid, which has no bound",
        )
