"""A stored verdict in plain words: what was asked, what each predicate says, why, how to check it again."""

import shlex
from collections.abc import Iterator, Sequence
from typing import Final
from urllib.parse import unquote

from predicates.case import Outcome
from predicates.record import StoredVerdict
from predicates.record.facts import Facts
from predicates.record.inputs import ANY_START, START_INPUT, UNKNOWN_INPUT
from predicates.record.stored import read_positions
from predicates.scope import tee_class_of_hash
from sdt_kg.iri import ID, LAW, Iri, local_name
from services.policy import USUAL_CONTACT, told_contact, told_friction
from services.why.words import (
    SHORT_KEY,
    Section,
    class_options,
    handle_force,
    margins,
    moved,
    of_then,
    reasons,
    standing,
    versions,
)

PREDICATES = {
    "SatisfiesRequest": "does the final state meet the request?",
    "Causes": "does the physics, replayed under the motion, end there?",
    "CanPerform": "can the robot do it inside its limits and without collision?",
}
"""What each asks; as statements they would contradict a no that stands beside them."""
MEANS = {
    Outcome.CERTIFIED: "All three predicates hold; the motion was checked by code that did not make it. "
    "Relative to {tee}: rigid bodies, {forces}, no error of perception; and to the models.",
    Outcome.NOT_CERTIFIED: "At least one predicate does not hold, or could not be shown to.",
    Outcome.ABSTAINED: "The case lies outside {tee}, so nothing is claimed: neither that it can be done "
    "nor that it cannot.",
}
NOTHING_KEPT: Final = (
    "neither certificate nor proof goes with this verdict: nothing could be verified without judging again"
)
CALCULATED: Final = (
    "no certificate or proof goes with this verdict: what it calls proved is a calculation from the twin, "
    "the request and what was given, and judging again repeats it"
)
TOLD: Final = frozenset({"move", "base", "drive", "robot"})
"""Kinds of edits that change no model: their state, start, drive and robot are told among the options."""
FORCES = {"D_artic": "no forces, no friction", "D_artic_dyn": "forces at the handle, the robot's as noted"}


def sections(
    verdict: StoredVerdict, facts: Facts, place: str, edits: Sequence[str] = ()
) -> tuple[Section, ...]:
    """The verdict in plain words, part by part; of a world that these edits had made another one."""
    changed = ("edited: " + "; ".join(edits),) if edits else ()
    parts = (
        Section(
            f"{question(verdict)} {outcome(verdict)}",
            (_means(verdict), *of_then(verdict.inputs, "the verdict keeps")),
        ),
        Section("Asked", (*_asked(verdict, facts), *changed)),
        Section("Answers", tuple(_answers(verdict, facts))),
        Section("Reasons", tuple(reasons(verdict.diagnoses))),
        Section("Margins", tuple(margins(verdict.figures))),
        Section("Notes", verdict.notes),
        Section("Versions and inputs", tuple(versions(verdict.inputs))),
        Section("To check again", tuple(_again(verdict, facts, place, edits))),
    )
    return tuple(each for each in parts if each.lines)


def outcome(verdict: StoredVerdict) -> str:
    """CERTIFIED, NOT CERTIFIED or ABSTAINED; of what another version judged, what it was."""
    return standing(verdict.outcome, verdict.inputs)


def means(outcome: Outcome, tee: str) -> str:
    """What an outcome claims, relative to the class of that name."""
    return MEANS[outcome].format(tee=tee, forces=FORCES.get(tee, "forces as it has them"))


def nothing_kept(verdict: StoredVerdict) -> str:
    """Of a verdict without artefact, that nothing re-verifies it, and on what rests what it calls proved."""
    return CALCULATED if any(each.proof for each in verdict.diagnoses) else NOTHING_KEPT


def question(verdict: StoredVerdict) -> str:
    """Who, what, where."""
    who = local_name(verdict.robot) if verdict.robot else "some motion"
    to_goal = dict(verdict.inputs).get("final", UNKNOWN_INPUT) != UNKNOWN_INPUT
    verb = (
        verdict.verb.value if verdict.verb else ("reach a goal with" if to_goal else "achieve something with")
    )
    what = local_name(verdict.container) if verdict.container else "a container"
    return f"Can {who} {verb} {what} in kitchen {local_name(verdict.environment)}?"


def _means(verdict: StoredVerdict) -> str:
    tee = tee_class_of_hash(dict(verdict.inputs).get("tee_class", ""))
    name = "a class of another version" if tee is None else tee.name
    text = means(verdict.outcome, name)
    if verdict.outcome is not Outcome.NOT_CERTIFIED:
        return text
    if not any(each.proof for each in verdict.diagnoses):
        return f"{text} Nothing is proved: {_ground(verdict)}."
    if _given(verdict):
        return f"{text} Proved of the motion that was given; another motion may still do it."
    return f"{text} Proved: a sound bound excludes every motion of the class {name}, not only those tried."


def _ground(verdict: StoredVerdict) -> str:
    """On what a refusal rests that is no proof."""
    if any(each.search is not None for each in verdict.diagnoses):
        return "the search gave up, which is no proof that it is impossible"
    if _given(verdict):
        return "this was measured of the motion that was given; another motion may still do it"
    return "this was measured of what was tried; another start or motion may still do it"


def _given(verdict: StoredVerdict) -> str:
    """Which motion was given to be verified; empty where it was to be found."""
    inputs = dict(verdict.inputs)
    names = {"body_motion": "the robot's motion", "motion": "the container's motion"}
    return next(
        (text for name, text in names.items() if inputs.get(name, UNKNOWN_INPUT) != UNKNOWN_INPUT), ""
    )


def _asked(verdict: StoredVerdict, facts: Facts) -> Iterator[str]:
    """The case: request, robot with drive and start, state, motion."""
    inputs = dict(verdict.inputs)
    yield f"request: {unquote(inputs.get('task', UNKNOWN_INPUT).replace(ID, ''))}"
    if verdict.robot:
        drive = facts.text(verdict.iri, LAW + "drive") or "not recorded"
        yield f"robot: {local_name(verdict.robot)}, its base moves: {drive}"
    if START_INPUT in inputs:
        yield f"start of the base: {_start(inputs[START_INPUT])}"
    elsewhere = moved(verdict.iri, facts)
    yield "kitchen: " + (
        ", ".join(elsewhere) + ", all else at its start" if elsewhere else "everything at its start"
    )
    allowed = handle_force(verdict.iri, facts, tee_class_of_hash(inputs.get("tee_class", "")))
    if allowed is not None:
        yield f"at every handle: {allowed:g} N allowed, whatever the force data say"
    given = _given(verdict)
    yield f"motion: {given} was given, to be verified" if given else "motion: to be found"
    for name in ("motion", "bodyMotion"):
        part = facts.text(verdict.iri, LAW + name)
        if part is not None:
            yield f"  {_motion(facts, part, name)}"


def _start(text: str) -> str:
    """x, y, yaw as the embodiment oracle writes them, or its sentence where there are none."""
    x, y, yaw, *words = text.split(", ") if text.count(",") > 1 else ("", "", "", text)
    if not x:
        return text
    return ", ".join((f"x {x} m", f"y {y} m", *(words or [f"yaw {yaw} rad"]), "arms parked"))


def _motion(facts: Facts, of: Iri, name: str) -> str:
    duration = f"{facts.measured(of, LAW + 'duration'):.3g} s"
    if name == "bodyMotion":
        return f"body motion of {duration}, {facts.measured(of, LAW + 'samples'):.0f} samples"
    start, end = facts.number(of, LAW + "startPosition"), facts.number(of, LAW + "endPosition")
    way = "" if start is None or end is None else f" from {start:.4g} to {end:.4g}"
    return f"{local_name(facts.needed(of, LAW + 'entity'))} moves{way} in {duration}"


def _answers(verdict: StoredVerdict, facts: Facts) -> Iterator[str]:
    """Each predicate: yes, no or not asked, with who answered and how long it took."""
    parts = {
        local_name(facts.needed(of, LAW + "predicate")): of for of in facts.all(verdict.iri, LAW + "answer")
    }
    holds = (verdict.satisfies_request, verdict.causes, verdict.can_perform)
    for (name, meaning), answer in zip(PREDICATES.items(), holds, strict=True):
        said = {True: "yes", False: "no", None: "not asked"}[answer]
        yield f"{name}: {said} ({meaning})"
        if name in parts:
            seconds = facts.number(parts[name], LAW + "seconds")
            took = "" if seconds is None else f", in {seconds:.3g} s"
            yield f"  answered by {facts.needed(parts[name], LAW + 'version')}{took}"
    yield f"all of it took {verdict.seconds:.3g} s"


def _again(verdict: StoredVerdict, facts: Facts, place: str, edits: Sequence[str]) -> Iterator[str]:
    """Commands that ask the same once more."""
    of_models = [each for each in edits if each.partition(":")[0] not in TOLD]
    command = _command(verdict, facts, of_models)
    if command and of_models:
        yield command
        yield "  models by the names that they were loaded with; without the edits it is another question"
    elif command:
        yield command
        yield (
            "  the same inputs give the same IRI; kitchen and robot by the names that they were loaded with, "
            "edited as they had been"
        )
    if facts.text(verdict.iri, LAW + "artefact") is not None:
        yield f"sdt recheck {verdict.iri} --store {place}"
        yield "  re-verifies what the verdict keeps, without the code that found it"
    else:
        yield f"  {nothing_kept(verdict)}"
    yield verdict.iri


def _command(verdict: StoredVerdict, facts: Facts, edits: Sequence[str]) -> str:
    """What asks the same; empty where the verdict was not about one request."""
    if not (verdict.verb and verdict.container and verdict.robot):
        return ""
    if edits and _given(verdict):
        return _reported(verdict, edits)
    asked = [*(word for name, value in _case(verdict).items() for word in (f"--{name}", value))]
    asked += [*_how(verdict, facts, achieve=not edits)]
    if not edits:
        return shlex.join(["sdt", "achieve", *asked])
    return shlex.join(["sdt", "whatif", *asked, *(word for each in edits for word in ("--edit", each))])


def _reported(verdict: StoredVerdict, edits: Sequence[str]) -> str:
    """The report that verifies a motion in the edited world."""
    inputs = dict(verdict.inputs)
    case = _case(verdict) | {"drive": inputs.get("embodiment.drive", "")}
    if (friction := told_friction(inputs.get("embodiment.tolerances", ""))) is not None:
        case["friction"] = repr(friction)
    case |= {"edits": "; ".join(edits), "motion": "FILE"}
    said = [word for name, value in case.items() for word in ("-p", f"{name}={value}")]
    return shlex.join(["sdt", "report", "diagnosis", *said])


def _case(verdict: StoredVerdict) -> dict[str, str]:
    """Who is asked to do what, where: option → value."""
    task = f"{verdict.verb.value if verdict.verb else ''}:{local_name(verdict.container or '')}"
    where, who = local_name(verdict.environment), local_name(verdict.robot or "")
    return {"kitchen": where, "robot": who, "task": task}


def options(verdict: StoredVerdict, facts: Facts) -> tuple[str, ...]:
    """What decided the verdict beside drive and state, as options; a motion that was given by its hash."""
    said = list[str]()
    for word in _how(verdict, facts, achieve=True):
        if word.startswith("--"):
            said.append(word)
        else:
            said[-1] += f" {word}"
    inputs = dict(verdict.inputs)
    given = (inputs.get(name, UNKNOWN_INPUT) for name in ("body_motion", "motion"))
    motion = next((each[:SHORT_KEY] for each in given if each != UNKNOWN_INPUT), "")
    said = [f"--motion FILE ({motion})" if each == "--motion FILE" else each for each in said]
    return tuple(each for each in said if each.split()[0] not in {"--drive", "--state"})


def _how(verdict: StoredVerdict, facts: Facts, *, achieve: bool) -> list[str]:
    """Options that decide the verdict besides; those that `sdt achieve` alone takes, for it."""
    inputs, words = dict(verdict.inputs), list[str]()
    for joint, value in read_positions(facts, verdict.iri).items():
        words += ["--state", f"{local_name(joint)}={value!r}"]
    words += class_options(verdict.iri, facts, tee_class_of_hash(inputs.get("tee_class", "")))
    drive = inputs.get("embodiment.drive")
    words += ["--drive", drive] if drive else []
    contact = told_contact(inputs.get("embodiment.tolerances", ""))
    if achieve and contact not in {None, USUAL_CONTACT}:
        words += ["--contact-tolerance", repr(contact)]
    if (friction := told_friction(inputs.get("embodiment.tolerances", ""))) is not None:
        words += ["--friction", repr(friction)]
    start = inputs.get(START_INPUT, "")
    if start.count(",") == 2:
        words += ["--base", start.replace(" ", "")]
    elif achieve and start == ANY_START:
        words.append("--any-start")
    for name in ("budget", "seed"):
        value = inputs.get(f"embodiment.{name}")
        words += [f"--{name}", value.removesuffix(" s")] if value else []
    return [*words, *(("--motion", "FILE") if achieve and _given(verdict) else ())]
