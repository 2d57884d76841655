"""How much of a change turns an outcome: every share that was judged."""

from collections.abc import Sequence
from dataclasses import dataclass

from predicates.counterfactual import Turn, smallest_turn
from sdt_kg.errors import InputError
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Table
from services.reports.scene.colors import COLORS
from services.reports.studies.words import color, said
from services.reports.studies.worlds import Question
from services.whatif import Change, World, parse_change


@dataclass(frozen=True, slots=True)
class Turning:
    """A change of which there is less, and the smallest share of it that turns a robot's outcome."""

    robot: str
    change: Change
    world: World
    turn: Turn


def searched(question: Question, robot: str, text: str, steps: int, tolerance: float) -> Turning:
    """The smallest share of an edit that turns the outcome.

    Args:
        question: What is asked.
        robot: Of whom.
        text: An edit of which there is less.
        steps: Of the first scan, at least 1.
        tolerance: [1] To which the share is told, above 0.

    Raises:
        InputError: The edit is none, or a whole one; or steps and tolerance are out of range.
    """
    change = parse_change(text)
    if not change.is_gradual:
        raise InputError(f"of '{text}' there is no half", allowed="move, set, base or handle")
    if steps < 1 or not 0 < tolerance <= 1:
        raise InputError(
            f"steps={steps}, tolerance={tolerance}", allowed="steps from 1, a tolerance in (0, 1]"
        )
    found = smallest_turn(lambda share: question.judged(change.at(question.ground, share)), steps, tolerance)
    return Turning(robot, change, question.ground, found)


def turning_figure(found: Sequence[Turning]) -> Figure:
    """How the outcome goes with the share of a change: every share that was judged."""
    with drawn(0.45 * max(1, len(found)) + 0.75) as drawing:
        axes = drawing.add_subplot()
        for row, each in enumerate(found):
            for tried in each.turn.tried:
                axes.plot(
                    100 * tried.share,
                    row,
                    "o",
                    color=COLORS[color(tried.verdict)],
                    markersize=6,
                    markeredgecolor="#55555c",
                )
            after = each.turn.after
            if after is not None:
                axes.axvspan(
                    100 * each.turn.before.share,
                    100 * after.share,
                    ymin=1 - (row + 0.95) / len(found),
                    ymax=1 - (row + 0.05) / len(found),
                    color="#dfe4ea",
                )
        axes.set_yticks(range(len(found)), [each.robot for each in found])
        axes.set(ylim=(max(1, len(found)) - 0.5, -0.5), xlim=(-2, 102))
        axes.set_xlabel(f"% of the change {found[0].change.text}" if found else "no change was searched")
    caption = (
        "Each share of the change that was judged: green certified, orange not certified, red proved"
        " impossible, grey abstained. Shaded: the outcome turns between these two shares. Between other dots"
        " it may turn and turn back unseen."
    )
    return Figure("counterfactual_turning", caption, drawing)


def turnings(found: Sequence[Turning]) -> Table:
    """The smallest share of the change that turns each robot's outcome."""
    rows = [_turn_row(each) for each in found]
    return Table.of(
        "counterfactual_turnings", "The smallest change that turns the outcome, among what was tried.", rows
    )


def _turn_row(one: Turning) -> dict[str, object]:
    before, after = one.turn.before, one.turn.after
    amount = one.change.amount
    assert amount is not None, "only gradual changes are searched"
    return {
        "robot": one.robot,
        "as it is": said(one.turn.tried[0].verdict),
        "turns to": "no turn found" if after is None else said(after.verdict),
        "at": "" if after is None else amount(one.world, after.share),
        "not yet at": amount(one.world, before.share),
        "verdicts": len(one.turn.tried),
    }
