"""A stored result of a task specification: steps, rules, which was broken when, J, how to check again."""

import shlex
from collections.abc import Iterator
from typing import Final

from predicates.case import Outcome
from predicates.margins import is_bound
from predicates.record.facts import Facts, term
from predicates.record.stored import OUTCOMES, read_diagnosis, read_inputs
from predicates.scope import tee_class_of_hash
from predicates.specification.model import Quality
from sdt_kg.iri import LAW, RDFS, Iri, local_name
from sdt_kg.numbers import so_many
from services.why.words import (
    SHORT_KEY,
    Section,
    class_options,
    in_capitals,
    moved,
    not_reached,
    of_then,
    reasons,
    standing,
    versions,
    with_unit,
)

MEANS: Final = {
    Outcome.CERTIFIED: "Every step is certified, and every rule is kept along those motions, between samples "
    "too.",
    Outcome.NOT_CERTIFIED: "A step is not certified, or a rule is broken by the motions that were found; "
    "others might keep it.",
    Outcome.ABSTAINED: "A step is out of scope, or a rule is not bounded: nothing is claimed.",
}
STANDING: Final = {"Kept": "kept", "Broken": "BROKEN", "NotBounded": "not bounded"}


def sections(iri: Iri, facts: Facts, place: str) -> tuple[Section, ...]:
    """The result in plain words, part by part."""
    outcome = outcome_of(iri, facts)
    steps, rules = facts.all(iri, LAW + "stepResult"), facts.all(iri, LAW + "ruleAnswer")
    diagnoses = [read_diagnosis(facts, each) for each in facts.all(iri, LAW + "diagnosis")]
    inputs = read_inputs(facts, iri)
    means = (MEANS[outcome], *of_then(inputs, "the verdicts of its steps keep"))
    parts = (
        Section(f"{question(iri, facts)} {standing(outcome, inputs)}", means),
        Section("Asked", tuple(_asked(iri, facts))),
        Section("Steps", tuple(line for each in steps for line in _step(each, facts))),
        Section("Rules", tuple(_rules(iri, rules, facts))),
        Section("Reasons", tuple(reasons(diagnoses))),
        Section("Quality", tuple(_quality(iri, facts))),
        Section("Versions and inputs", tuple(versions(inputs))),
        Section("To check again", tuple(_again(iri, steps, facts, place))),
    )
    return tuple(each for each in parts if each.lines)


def question(iri: Iri, facts: Facts) -> str:
    """Who, what, where."""
    who = local_name(facts.needed(iri, LAW + "robot"))
    where = local_name(facts.needed(iri, LAW + "environment"))
    return f"Can {who} do '{facts.needed(iri, RDFS + 'label')}' in kitchen {where}?"


def outcome_of(of: Iri, facts: Facts) -> Outcome:
    """What became of a task, or of one of its steps."""
    return term(OUTCOMES, facts.needed(of, LAW + "taskOutcome"))


def request(asked: Iri, facts: Facts) -> str:
    """What one step asks for."""
    goal = facts.number(asked, LAW + "goalPosition")
    verb = local_name(facts.needed(asked, LAW + "verb")).lower()
    what = f"{verb} {local_name(facts.needed(asked, LAW + 'container'))}"
    return what + ("" if goal is None else f" to {goal:g}")


def _asked(iri: Iri, facts: Facts) -> Iterator[str]:
    yield f"specification: {facts.needed(iri, LAW + 'specification')}"
    steps, rules = (int(facts.measured(iri, LAW + name)) for name in ("stepsAsked", "rulesAsked"))
    yield f"{so_many(steps, 'step', 'steps')}, {so_many(rules, 'rule', 'rules')}"
    elsewhere = moved(iri, facts)
    at = ", ".join(elsewhere) + ", all else at its start" if elsewhere else "everything at its start"
    yield f"kitchen before the first step: {at}"


def _step(of: Iri, facts: Facts) -> Iterator[str]:
    """The request with its outcome; the verdict, and by what the motion was chosen."""
    task = facts.needed(of, LAW + "task")
    said = in_capitals(outcome_of(of, facts))
    yield f"{facts.measured(task, LAW + 'index'):.0f}. {request(task, facts)}: {said}"
    yield f"  verdict {local_name(facts.needed(of, LAW + 'verdict'))[:SHORT_KEY]}"
    if facts.text(of, LAW + "bodyMotion") is None:
        return
    compared, searches, seed = (
        f"{facts.measured(of, LAW + name):.0f}" for name in ("compared", "searches", "searchSeed")
    )
    value = facts.number(of, LAW + "qualityValue")
    unit = facts.text(of, LAW + "unit") or "1"
    by = facts.text(of, LAW + "comparedBy")
    said = "no value of J" if value is None else with_unit(value, unit, bound=_is_bound(by, value))
    if by is None:
        said = "the first"
    yield f"  motion of seed {seed}, {said}: of {compared} certified that broke no rule, {searches} searched"


def _rules(iri: Iri, rules: list[Iri], facts: Facts) -> Iterator[str]:
    first = facts.text(iri, LAW + "firstBroken")
    for index, each in enumerate(rules, 1):
        standing = STANDING[local_name(facts.needed(each, LAW + "standing"))]
        yield f"{index}. {standing}: {facts.needed(each, RDFS + 'label')}"
        yield f"  checked {facts.needed(each, LAW + 'checkedHow')}"
        step, time = facts.text(each, LAW + "inStep"), facts.number(each, LAW + "time")
        if step is not None:
            when = "" if time is None else f" at {time:.4g} s"
            yield f"  in step {local_name(step)}{when}" + (", before any other rule" if each == first else "")
            elsewhere = moved(each, facts)
            if elsewhere:
                yield f"  with {', '.join(elsewhere)}, all else at its start"
    yield from not_reached(int(facts.measured(iri, LAW + "rulesAsked")) - len(rules))


def _quality(iri: Iri, facts: Facts) -> Iterator[str]:
    by, value = facts.text(iri, LAW + "comparedBy"), facts.number(iri, LAW + "qualityValue")
    if by is not None:
        unit = facts.text(iri, LAW + "unit") or "1"
        said = "no value" if value is None else with_unit(value, unit, bound=_is_bound(by, value))
        yield f"J = {local_name(by)}: {said}, of the best found, step by step; not the optimum"
        if local_name(by) == "MechanicalWork":
            yield "bodies of which the robot's model gives no mass count as weightless in it"


def _is_bound(quality: str | None, value: float) -> bool:
    """Whether a value of J is a clearance up to which was looked."""
    return quality == LAW + Quality.CLEARANCE.value and is_bound(value)


def _again(iri: Iri, steps: list[Iri], facts: Facts, place: str) -> Iterator[str]:
    kept = facts.text(iri, LAW + "writtenAs") is not None
    if kept:
        yield f"sdt recheck {iri} --store {place}"
    tee = tee_class_of_hash(dict(read_inputs(facts, iri)).get("tee_class", ""))
    where, who = (local_name(facts.needed(iri, LAW + name)) for name in ("environment", "robot"))
    asked = ["sdt", "task", "FILE", "--kitchen", where, "--robot", who]
    yield shlex.join([*asked, *class_options(iri, facts, tee)])
    what = "the specification (its law:writtenAs)" if kept else "the specification"
    yield f"  FILE: {what}, or the ready task that {facts.needed(iri, LAW + 'specification')} is"
    for each in steps:
        yield f"sdt why {facts.needed(each, LAW + 'verdict')} --store {place}"
    yield iri
