"""The same question in two worlds, or at every share of a change: the verdicts, and what is told of them."""

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

from predicates.case import Verdict
from predicates.counterfactual import Contrast, Turn, smallest_turn, widest_gap
from predicates.meant import asked_about
from predicates.record import diagnosis_json, to_json
from sdt_kg.errors import InputError
from services.requests import parse_task
from services.whatif.change import GRADUAL, Change, changed
from services.whatif.world import World

SCAN: Final = 8
"""Shares of the change that are tried first."""
TOLERANCE: Final = 0.01
"""[1] Of the share of the change, to which the smallest one is told."""
MOST_SHARES: Final = 1 + SCAN + math.ceil(math.log2(1 / (SCAN * TOLERANCE)))
"""[1] Judged at most: none of the change, those of the first scan, and halves of one of its steps."""

Json = dict[str, Any]  # JSON object


def answered(
    world: World, task: str, changes: Sequence[Change], *, turn: bool = False
) -> tuple[Json, list[Verdict]]:
    """What `sdt whatif --json` prints, and the verdicts on which it rests, that of the world as it is first.

    Args:
        world: As it is.
        task: `open:CONTAINER` or `close:CONTAINER`.
        changes: Made in their order.
        turn: Whether the smallest share of the changes is searched at which the outcome turns; those of which
            there is no half are made from the beginning of it.

    Raises:
        InputError: A change that cannot be made, a task that there is not in both worlds or that is several
            questions, no half of any change: said before anything is judged.
    """
    return _turning(world, task, changes) if turn else _contrasted(world, task, changes)


def _contrasted(world: World, task: str, changes: Sequence[Change]) -> tuple[Json, list[Verdict]]:
    other = changed(world, tuple(changes))
    for each in (world, other):
        _check_one(each, task)
    found = Contrast(_verdict(world, task), _verdict(other, task))
    said = {
        "edits": [each.text for each in changes],
        "turned": found.turned,
        **_differences(found),
        "actual": to_json(found.actual),
        "counterfactual": to_json(found.counterfactual),
    }
    return said, [found.actual, found.counterfactual]


def _turning(world: World, task: str, changes: Sequence[Change]) -> tuple[Json, list[Verdict]]:
    gradual = tuple(each for each in changes if each.is_gradual)
    if not gradual:
        raise InputError(
            "no edit can be made in part, and a turn is sought between nothing and all of one",
            allowed=f"at least one of {', '.join(f'{each}:' for each in GRADUAL)}",
            remedy="--edit help lists edits",
        )
    ground = changed(world, tuple(each for each in changes if not each.is_gradual))
    for each in (ground, changed(ground, gradual)):
        _check_one(each, task)
    found = smallest_turn(lambda share: _verdict(changed(ground, gradual, share), task), SCAN, TOLERANCE)
    said = _turn_json(found, lambda share: [_amount(each, ground, share) for each in gradual])
    return said, [each.verdict for each in found.tried]


def _turn_json(found: Turn[Verdict], amounts: Callable[[float], list[str]]) -> Json:
    after = found.after
    return {
        "found": after is not None,
        "actual": to_json(found.tried[0].verdict),
        "share": None if after is None else after.share,
        "edits": None if after is None else amounts(after.share),
        "not_yet": amounts(found.before.share),
        "tolerance": found.gap,
        "apart_at_most": widest_gap([each.share for each in found.tried], after.share if after else 1.0),
        "counterfactual": None if after is None else to_json(after.verdict),
        **({} if after is None else _differences(Contrast(found.tried[0].verdict, after.verdict))),
        "tried": [
            {"share": each.share, "edits": amounts(each.share), "outcome": each.verdict.outcome.value}
            for each in found.tried
        ],
        "searched": {"from": 0.0, "to": 1.0, "first_steps": SCAN, "tolerance": TOLERANCE},
    }


def _check_one(world: World, task: str) -> None:
    """The task is one question in this world."""
    twin = world.service.twin
    count = len(asked_about(twin, parse_task(twin, task)))
    if count > 1:
        raise InputError(f"'{task}' is {count} questions", allowed="one container, open:CONTAINER say")


def _verdict(world: World, task: str) -> Verdict:
    (verdict,) = world.service.achieve(task, world.robot_iri)
    return verdict


def _amount(change: Change, world: World, share: float) -> str:
    assert change.amount is not None, "a gradual one"
    return change.amount(world, share)


def _differences(found: Contrast) -> Json:
    """Predicates that answer otherwise, and the reasons that are gone or new."""
    return {
        "predicates": [
            {"predicate": name, "actual": before, "counterfactual": after}
            for name, before, after in found.turned_predicates()
        ],
        "no_longer": [diagnosis_json(each) for each in found.gone()],
        "now": [diagnosis_json(each) for each in found.new()],
    }
