"""Why a verdict is what it is: its story, its evidence, and where in the motion it lies."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from predicates.case import Diagnosis, Evidence, Verdict
from predicates.margins import COUNTED, at_least
from predicates.record import to_record
from predicates.record.report import figures
from sdt_kg.errors import InputError
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion, Motion
from services.embodiment.certify.motion import whole_motion
from services.embodiment.certify.tolerances import Tolerances
from services.motions import read_motion
from services.physics.model import Scene
from services.physics.tree import build
from services.reports.pages.figure import Figure, drawn
from services.reports.pages.table import Table
from services.reports.scene.camera import beside
from services.reports.scene.clip import Clip, Line, body_clip, container_clip, posture_clip
from services.reports.scene.gap import gap
from services.reports.scene.paper import draw
from services.reports.scene.region import excluded
from services.reports.scene.view import View, view_of
from services.reports.studies.course import courses, courses_figure
from services.reports.studies.judged import opened
from services.reports.studies.words import said
from services.reports.studies.worlds import Question, certified_motion, changes_of, scene_of, world_of
from services.whatif import World, changed
from services.why import sections

SHOWN_FAILURES = 4
"""[1] Moments of a motion that are shown one by one."""


@dataclass(frozen=True)
class Diagnosed:
    """One verdict, with the world and the motion that it is about.

    Attributes:
        task: `open:NAME` or `close:NAME`.
        origin: Where the motion comes from, in words.
        motion: Of the robot, or of the container alone; None where there is none.
        lacks: Why there is none of the robot, where there is none.
        edits: By which the world had become another one.
    """

    world: World
    task: str
    verdict: Verdict
    origin: str
    motion: BodyMotion | Motion | None
    edits: tuple[str, ...] = ()
    lacks: str = "the search found none"

    @cached_property
    def scene(self) -> Scene:
        """Kitchen and robot."""
        return scene_of(self.world)


def diagnosed(  # noqa: PLR0913 - the options of sdt achieve
    kitchen: str,
    robot: str,
    task: str,
    *,
    edits: str = "",
    motion: str = "",
    state: str = "",
    base: str = "",
    drive: str = "",
    friction: str = "",
    budget: float = 20.0,
    store: str = "",
) -> Diagnosed:
    """The verdict of a motion in a kitchen, which may have been edited since the motion was made.

    Args:
        kitchen: Bundled name or path.
        robot: Bundled name or path.
        task: `open:NAME` or `close:NAME`.
        edits: As sdt whatif takes them, separated by semicolons.
        motion: A motion's file. Without one, and with edits that leave the robot, the motion that is
            certified without them; with neither, the motion that is looked for.
        state: Joints elsewhere, comma-separated.
        base: Where the robot starts: X,Y,YAW.
        drive: omni, differential or fixed.
        friction: Coefficient with which fingers rub on handles, as text; empty: verdicts say what is needed.
        budget: Seconds of search.
        store: Where verdicts are recalled from and kept.

    Raises:
        InputError: Something of these does not exist.
    """
    how = {"state": state, "base": base, "drive": drive, "friction": friction}
    ground = world_of(kitchen, robot, **how, budget=budget)
    changes = changes_of(edits)
    world, lacks = changed(ground, changes), Diagnosed.lacks
    with opened(store) as saved, opened("") as edited:
        question = Question(task, ground, saved, edited)
        given, origin = None, "looked for by the planner"
        if motion:
            path = Path(motion)
            if not path.is_file():
                raise InputError(f"no file '{motion}'", allowed="a motion: .npz, .json, .csv or .mcap")
            given, origin = read_motion(path, ground.service.twin, ground.robot_iri), f"read from {path.name}"
        elif changes and world.robot_iri == ground.robot_iri:
            given = certified_motion(question.judged(ground))
            origin = "certified before the edits" if given is not None else origin
        verdict = question.judged(world, given)
        if isinstance(given, BodyMotion) and given.robot != world.robot_iri:
            given, lacks = None, "the one that is given is of another robot"
        shown = given or certified_motion(verdict) or _caused(world, task)
        return Diagnosed(world, task, verdict, origin, shown, tuple(each.text for each in changes), lacks)


def _caused(world: World, task: str) -> Motion | None:
    """The container's motion by which Causes answers."""
    motions = [each.case.motion for each in world.service.causes(task)]
    return next((each for each in motions if isinstance(each, Motion)), None)


def headline(found: Diagnosed) -> Table:
    """The question, the outcome, and each predicate's answer."""
    verdict = found.verdict
    answers = (verdict.satisfies_request, verdict.causes, verdict.can_perform)
    row = {
        "question": f"{local_name(found.world.robot_iri)}, {found.task}",
        "motion": found.origin,
        "verdict": said(verdict),
    }
    names = ("SatisfiesRequest", "Causes", "CanPerform")
    row |= {
        name: "not asked" if each is None else each.holds for name, each in zip(names, answers, strict=True)
    }
    return Table.of("diagnosis_verdict", "What was asked, and what each predicate says.", [row])


def story(found: Diagnosed) -> Table:
    """The verdict in plain words, as `sdt why` tells it."""
    parts = sections(list(to_record(found.verdict).quads()), found.verdict.iri, edits=found.edits)
    kept = [each for each in parts if each.title not in {"Versions and inputs"}]
    rows = [
        {"part": "" if i else each.title, "in words": line.strip()}
        for each in kept
        for i, line in enumerate(each.lines)
    ]
    return Table.of("diagnosis_story", "The verdict in plain words.", rows)


def evidence(found: Diagnosed) -> Table:
    """Every reason with what it measures against what it had to keep."""
    rows = [_row(each) for each in found.verdict.diagnoses]
    return Table.of("diagnosis_evidence", "Every reason, and what it rests on.", rows)


def _row(diagnosis: Diagnosis) -> dict[str, object]:
    of = diagnosis.evidence
    search = diagnosis.search
    tried = "" if search is None else str(search)
    return {
        "kind": diagnosis.kind.value.replace("_", " "),
        "reason": diagnosis.reason,
        "quantity": None if of is None else of.quantity.value,
        "value": None if of is None else of.value,
        "bound": None if of is None or math.isnan(of.bound) else of.bound,
        "unit": None if of is None or of.unit == "1" else of.unit,
        "at [s]": None if of is None else of.time,
        "shown by": "a proof" if diagnosis.proof else tried or "measurement",
    }


def margins(found: Diagnosed) -> Table:
    """What a certified motion keeps; empty for what is not certified."""
    kept = figures(found.verdict)
    bounds = at_least(kept)
    rows = [
        {
            "margin": name + (", at least" if name in bounds else ""),
            "value": value,
            "unit": "" if unit == "1" else unit,
        }
        for name, (value, unit) in kept.items()
        if not name.startswith(COUNTED)
    ]
    caption = "What the certificate keeps; none where nothing is certified."
    return Table.of("diagnosis_margins", caption, rows or [{"margin": "none", "value": None, "unit": None}])


def course(found: Diagnosed) -> Figure:
    """What the reasons measure, along the whole motion."""
    if not isinstance(found.motion, BodyMotion):
        said = f"no body motion to measure: {found.lacks}"
        return _no_course(said, "There is no motion of the robot to measure along.")
    measured = courses(found.verdict, found.scene, found.motion)
    if measured:
        return courses_figure(measured, found.motion, "diagnosis_course")
    why = "no reason has a time" if found.verdict.diagnoses else "nothing was refused"
    return _no_course(why, "Of reasons that have a time: what they measure, along the motion.")


def _no_course(said: str, caption: str) -> Figure:
    with drawn(0.6) as drawing:
        axes = drawing.add_subplot()
        axes.set_axis_off()
        axes.text(0.5, 0.5, said, ha="center", va="center")
    return Figure("diagnosis_course", caption, drawing)


def view(found: Diagnosed) -> View:
    """The motion, and each moment at which a reason lies: offending bodies red, the gap drawn."""
    clips = [*_moments(found), _motion_clip(found)]
    title = (
        "Choose a moment or the motion. Red: the bodies that a reason is about; violet: their nearest points."
    )
    if not found.verdict.diagnoses:
        title = "The certified motion."
    return view_of(found.world.service.twin, [found.scene], title, clips)


def _motion_clip(found: Diagnosed) -> Clip:
    name = f"{found.task}, the motion"
    note = f"Motion: {found.origin}."
    if isinstance(found.motion, BodyMotion):
        return body_clip(name, found.scene, found.motion, note)
    robot = found.scene.robot.mechanism.name
    red = frozenset(
        link for each in found.verdict.diagnoses if each.evidence for link in each.evidence.links or ()
    )
    if found.motion is None or found.motion.is_poses:
        return Clip(name, robot, np.zeros(1), red=red, note=f"No motion: {found.lacks}.")
    twin = found.world.service.twin
    clip = container_clip(name, build(twin.mechanism(twin.environment)), twin, found.motion)
    note = f"The container's motion alone, none of the robot: {found.lacks}. Red: what the reasons are about."
    proved = tuple(excluded(twin, found.verdict))
    note += f" Violet: {proved[0].label}." if proved else ""
    return replace(clip, robot=robot, red=red, lines=proved, note=note)


def _moments(found: Diagnosed) -> list[Clip]:
    """The postures in which the reasons lie."""
    motion = found.motion
    if not isinstance(motion, BodyMotion):
        return []
    pieces, _ = whole_motion(found.scene, motion, Tolerances())
    clips = list[Clip]()
    for each in found.verdict.diagnoses:
        if each.evidence is None or each.evidence.time is None:
            continue
        time = each.evidence.time
        piece = np.searchsorted(pieces.start, [time], side="right") - 1
        piece = np.clip(piece, 0, len(pieces.start) - 1)
        q = pieces.at(piece, time - pieces.start[piece])[0][0]
        clips.append(_moment(found, each, each.evidence, q))
    return clips[:SHOWN_FAILURES]


def _moment(found: Diagnosed, diagnosis: Diagnosis, of: Evidence, q: np.ndarray) -> Clip:
    clip = posture_clip(f"{of.time:.2f} s: {diagnosis.reason}", found.scene, q, diagnosis.reason)
    lines, base = tuple[Line, ...](), q[found.scene.base]
    at = np.array([[base[0], base[1], 0.5]])
    if of.links is not None and (between := gap(found.scene, q, of.links)) is not None:
        lines = (Line(between[1], f"nearest points, {_apart(between[0])}", "gap"),)
        at = between[1]
    start = found.world.service.twin.kitchen().start
    camera = beside(at, base[:2], (start[0], start[1]))
    return replace(clip, ghost=True, red=_offending(found, of), lines=lines, camera=camera)


def _apart(distance: float) -> str:
    """A signed distance [m] in words."""
    return f"{1000 * abs(distance):.1f} mm {'apart' if distance >= 0 else 'in each other'}"


def _offending(found: Diagnosed, of: Evidence) -> frozenset[str]:
    """Bodies that a measurement is about: two links, or what a joint carries."""
    if of.links is not None:
        return frozenset(of.links)
    for model in (found.world.service.twin.environment, found.world.robot_iri):
        for joint in found.world.service.twin.mechanism(model).joints:
            if of.entity == f"{model}/joint/{joint.name}":
                return frozenset([f"{model}/body/{joint.child}"])
    return frozenset([of.entity] if of.entity else ())


def picture(shown: View) -> Figure:
    """The last moment on paper, or the motion's end where there is none."""
    clip = shown.clips[max(0, len(shown.clips) - 2)]
    with drawn(3.6) as drawing:
        draw(drawing.add_subplot(), shown, clip)
    return Figure("diagnosis_scene", clip.note or clip.name, drawing)
