"""The same question in other worlds: what turns, why, and from how much of a change on."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass

from predicates.counterfactual import Contrast
from predicates.record.report import WORDS
from sdt_kg.errors import InputError
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Cell, Table
from services.reports.scene.clip import body_clip
from services.reports.scene.paper import draw
from services.reports.scene.view import View, view_of
from services.reports.studies.judged import opened
from services.reports.studies.turning import Turning, searched
from services.reports.studies.words import cell, color, reasons, said
from services.reports.studies.worlds import Question, certified_motion, changes_of, scene_of, world_of
from services.whatif import Change, World, changed


@dataclass(frozen=True, slots=True)
class Otherwise:
    """One robot in one other world.

    Attributes:
        robot: Name of the robot in the world as it is.
        edits: What is otherwise.
        world: The other world; None where the edit cannot be made.
        contrast: The two verdicts; None where there is no other world.
        refusal: Why there is none.
    """

    robot: str
    edits: tuple[Change, ...]
    world: World | None
    contrast: Contrast | None
    refusal: str = ""

    @property
    def text(self) -> str:
        """The edits as they are written."""
        return "; ".join(each.text for each in self.edits)


@dataclass(frozen=True, slots=True)
class Counterfactual:
    """All worlds of a report.

    Attributes:
        grounds: Robot → the world as it is.
        others: Edit by edit, in each robot by robot.
        turnings: Robot by robot; empty where no change was to be searched.
    """

    task: str
    grounds: dict[str, World]
    others: tuple[Otherwise, ...]
    turnings: tuple[Turning, ...]


def judged(  # noqa: PLR0913 - the options of sdt whatif
    kitchen: str,
    robots: str,
    task: str,
    edits: str,
    *,
    together: bool = False,
    turn: str = "",
    steps: int = 4,
    tolerance: float = 0.05,
    state: str = "",
    base: str = "",
    drive: str = "",
    friction: str = "",
    budget: float = 20.0,
    store: str = "",
) -> Counterfactual:
    """Every robot's verdict as it is, and after each edit.

    Args:
        kitchen: Bundled name or path.
        robots: Comma-separated.
        task: `open:NAME` or `close:NAME`.
        edits: As sdt whatif takes them, separated by semicolons.
        together: Whether all edits make one other world, instead of one each.
        turn: An edit of which the smallest share that turns the outcome is searched; empty: none.
        steps: Of the first scan of that share.
        tolerance: [1] To which the share is told.
        state: Joints elsewhere, comma-separated.
        base: Where the robots start: X,Y,YAW.
        drive: omni, differential or fixed.
        friction: Coefficient with which fingers rub on handles, as text; empty: verdicts say what is needed.
        budget: Seconds of search.
        store: Where verdicts are recalled from and kept.

    Raises:
        InputError: Something of these does not exist.
    """
    every = changes_of(edits)
    worlds = [every] if together else [(each,) for each in every]
    if not every:
        raise InputError(
            "no edit is given", allowed="edits, separated by semicolons", remedy="sdt whatif --edit help"
        )
    options = {"state": state, "base": base, "drive": drive, "friction": friction}
    names = [each.strip() for each in robots.split(",") if each.strip()]
    grounds = {name: world_of(kitchen, name, **options, budget=budget) for name in names}
    for each in worlds:
        _check_edits(grounds.values(), each)
    with opened(store) as saved, opened("") as edited:
        asked = {name: Question(task, ground, saved, edited) for name, ground in grounds.items()}
        others = [_otherwise(question, name, each) for each in worlds for name, question in asked.items()]
        turnings = [
            searched(question, name, turn, steps, tolerance) for name, question in asked.items() if turn
        ]
    return Counterfactual(task, grounds, tuple(others), tuple(turnings))


def _check_edits(grounds: Collection[World], edits: tuple[Change, ...]) -> None:
    """The edits make another world for some robot.

    Raises:
        InputError: For none; as the first robot has it.
    """
    refused: list[InputError] = []
    for ground in grounds:
        try:
            changed(ground, edits)
        except InputError as error:
            refused.append(error)
    if len(refused) == len(grounds):
        raise refused[0]


def _otherwise(question: Question, robot: str, edits: tuple[Change, ...]) -> Otherwise:
    actual = question.judged(question.ground)
    try:
        world = changed(question.ground, edits)
    except InputError as error:
        return Otherwise(robot, edits, None, None, str(error))
    return Otherwise(robot, edits, world, Contrast(actual, question.judged(world)))


def outcomes(found: Counterfactual) -> Table:
    """Edits by robots: the outcome after each, and whether it turned."""
    robots = tuple(found.grounds)
    rows: list[tuple[object, ...]] = [("as it is", *(_actual(found, robot) for robot in robots))]
    for edits in dict.fromkeys(each.text for each in found.others):
        each = {one.robot: one for one in found.others if one.text == edits}
        rows.append((edits, *(_after(each[robot]) for robot in robots)))
    caption = (
        f"{found.task}: as it is, and after each edit; an arrow marks what turned. Certified fields play."
    )
    return Table("counterfactual_outcomes", caption, ("edit", *robots), tuple(rows))


def _actual(found: Counterfactual, robot: str) -> Cell:
    contrast = next((each.contrast for each in found.others if each.robot == robot and each.contrast), None)
    if contrast is None:
        return Cell("no other world", "")
    return cell(contrast.actual, _clip_name(robot, "as it is") if certified_motion(contrast.actual) else "")


def _after(one: Otherwise) -> Cell:
    if one.contrast is None:
        return Cell("no such world", "abstained", title=one.refusal)
    verdict = one.contrast.counterfactual
    arrow = "→ " if one.contrast.turned else ""
    clip = _clip_name(one.robot, one.text) if certified_motion(verdict) else ""
    return Cell(arrow + said(verdict), color(verdict), clip, reasons(verdict))


def _clip_name(robot: str, edits: str) -> str:
    return f"{robot}: {edits}"


def turned(found: Counterfactual) -> Table:
    """Which predicate turns, which reason goes and which comes."""
    rows = [row for each in found.others for row in _turned_rows(each)]
    return Table.of(
        "counterfactual_turned", "What each edit changes; none where every answer and reason stays.", rows
    )


def _turned_rows(one: Otherwise) -> Iterator[dict[str, object]]:
    head: dict[str, object] = {"edit": one.text, "robot": one.robot}
    if one.contrast is None:
        yield head | {"what": "no such world", "in words": one.refusal}
        return
    for name, before, after in one.contrast.turned_predicates():
        yield head | {"what": name, "in words": f"{WORDS[before]}, otherwise {WORDS[after]}"}
    for what, diagnoses in (("no longer", one.contrast.gone()), ("now", one.contrast.new())):
        for each in diagnoses:
            yield head | {"what": what, "in words": each.reason}


def views(found: Counterfactual) -> tuple[View, ...]:
    """Each world in which a motion is certified: the kitchen as it then is, with the motions to play."""
    made = list[View]()
    for text in ("as it is", *dict.fromkeys(each.text for each in found.others)):
        worlds = list(_certified(found, text))
        if worlds:
            scenes = [scene_of(world) for world, _, _ in worlds]
            clips = [
                body_clip(_clip_name(robot, text), scene, motion, f"Certified, {text}.")
                for scene, (_, robot, motion) in zip(scenes, worlds, strict=True)
            ]
            made.append(view_of(worlds[0][0].service.twin, scenes, f"{found.task}: {text}", clips))
    return tuple(made)


def _certified(found: Counterfactual, text: str) -> Iterator[tuple]:
    """World, robot and motion of each certificate in a world."""
    seen = set[str]()
    for each in found.others:
        if each.contrast is None or each.robot in seen:
            continue
        actual = text == "as it is"
        if not actual and each.text != text:
            continue
        motion = certified_motion(each.contrast.actual if actual else each.contrast.counterfactual)
        world = found.grounds[each.robot] if actual else each.world
        if motion is not None and world is not None:
            seen.add(each.robot)
            yield world, each.robot, motion


def picture(shown: tuple[View, ...]) -> Figure:
    """The worlds side by side on paper: the end of the first motion of each."""
    first = shown[:2]
    with drawn(1.9) as drawing:
        for axes, each in zip(drawing.subplots(1, max(1, len(first)), squeeze=False)[0], first, strict=False):
            draw(axes, each, each.clips[0], width=900)
            axes.set_title(each.clips[0].name)
        if not first:
            drawing.axes[0].set_axis_off()
    caption = (
        "The end of a certified motion, world by world."
        if first
        else "Nothing is certified in any of the worlds."
    )
    return Figure("counterfactual_scene", caption, drawing)
