"""What verdicts and results of tasks have in common, in plain words."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final
from urllib.parse import unquote

from predicates.case import Diagnosis, Evidence, Kind, Outcome, Quantity
from predicates.margins import AT_LEAST, told_figures
from predicates.record.facts import Facts
from predicates.record.inputs import UNKNOWN_INPUT, Inputs
from predicates.record.report import SIGNIFICANT, against, in_the_way
from predicates.record.stored import read_positions
from sdt_kg.iri import ID, LAW, Iri, local_name
from sdt_kg.numbers import so_many, told_apart
from sdt_kg.scope import D_ARTIC, TeeClass
from services.versions import outdated

SHORT_KEY = 12
"""[characters] Of a hash, where people read it."""
STORE = "STORE"
"""In commands to go on with, where nobody says what a shell would call the store."""
_DEMANDS: Final = {
    "LessThanConstraintComponent": "below",
    "LessThanOrEqualsConstraintComponent": "at most",
    "MaxCountConstraintComponent": "no more values than",
    "MaxExclusiveConstraintComponent": "below",
    "MaxInclusiveConstraintComponent": "at most",
    "MinCountConstraintComponent": "so many values at least:",
    "MinExclusiveConstraintComponent": "above",
    "MinInclusiveConstraintComponent": "at least",
}
"""Constraint of SHACL → what stands before its bound."""
SETTINGS = re.compile(r"^[A-Z]\w*\(((?:\w+=[-+.\deinf]+(?:, )?)+)\)$")
"""Settings as Python writes them, all numbers: as they are hashed, not as people read them."""


@dataclass(frozen=True, slots=True)
class Section:
    """One part of the story.

    Attributes:
        title: A word or two.
        lines: Sentences; those which begin with two blanks belong to the line before.
    """

    title: str
    lines: tuple[str, ...]


def in_capitals(outcome: Outcome) -> str:
    """CERTIFIED, NOT CERTIFIED or ABSTAINED."""
    return outcome.value.replace("_", " ").upper()


def standing(outcome: Outcome, inputs: Inputs) -> str:
    """CERTIFIED, NOT CERTIFIED or ABSTAINED; of what another version judged, what it was."""
    said = in_capitals(outcome)
    return f"OUTDATED, WAS {said}" if outdated(dict(inputs)) else said


def of_then(inputs: Inputs, keeps: str) -> Iterator[str]:
    """That another version judged, and what to do; `keeps` says who keeps what can be verified."""
    others = outdated(dict(inputs))
    if others:
        yield (
            f"Judged by {', '.join(others)}: this is not the answer to a question that is asked now. "
            f"Ask again, and it is judged anew; sdt recheck verifies what {keeps}."
        )


def moved(judged: Iri, facts: Facts) -> list[str]:
    """Joints that are elsewhere than where the kitchen starts, each with its position."""
    return [f"{local_name(joint)} at {at:.6g}" for joint, at in read_positions(facts, judged).items()]


def handle_force(judged: Iri, facts: Facts, tee: TeeClass | None) -> float | None:
    """[N] What who asked allowed at every handle; None where the force data were to count, or no forces."""
    return None if tee in {None, D_ARTIC} else facts.number(judged, LAW + "handleForce")


def class_options(judged: Iri, facts: Facts, tee: TeeClass | None) -> list[str]:
    """Options of a command that asks relative to the same class."""
    if tee is None or tee == D_ARTIC:
        return []
    allowed = handle_force(judged, facts, tee)
    return ["--tee", tee.name.lower(), *(() if allowed is None else ("--handle-force", repr(allowed)))]


def reasons(diagnoses: Iterable[Diagnosis]) -> Iterator[str]:
    """Each reason, and what it rests on."""
    every = tuple(diagnoses)
    outside = any(each.kind is Kind.OUT_OF_SCOPE for each in every)
    for index, each in enumerate(every, 1):
        yield f"{index}. {each.kind.value.replace('_', ' ')}: {each.reason}"
        yield from (f"  {line}" for line in _measures(each))
        yield from () if outside else (f"  {line}" for line in _grounds(each))


def _measures(diagnosis: Diagnosis) -> Iterator[str]:
    """What was measured, or the SHACL result."""
    violation = diagnosis.violation
    if violation is not None:
        path = f", property {local_name(violation.path)}" if violation.path else ""
        if violation.component is None:
            yield f"found beside SHACL: {local_name(violation.focus)}{path}"
        else:
            yield f"SHACL result: {local_name(violation.focus)}{path}, shape {local_name(violation.shape)}"
        value, bound = _compared(violation.value, violation.bound)
        demanded = f"{_DEMANDS.get(local_name(violation.component or ''), '')} {bound}"
        yield f"  value {value}, demanded: {demanded.strip()}"
    elif diagnosis.evidence is not None and not _of_search(diagnosis):
        yield _measured(diagnosis.evidence)


def _grounds(diagnosis: Diagnosis) -> Iterator[str]:
    """How sure a reason is: a proof, a search, or what was measured of one motion."""
    if diagnosis.proof:
        yield "proved"
    elif diagnosis.search is not None:
        yield f"not proved: {diagnosis.search}, then gave up"
    elif diagnosis.evidence is not None:
        yield "of this motion and start; of others nothing is proved"
    else:
        yield "not proved"


def _of_search(diagnosis: Diagnosis) -> bool:
    """Whether what is measured is how long was searched: of the search, not of the body that it names."""
    evidence = diagnosis.evidence
    return diagnosis.search is not None and evidence is not None and evidence.quantity is Quantity.TIME


def _measured(evidence: Evidence) -> str:
    who = [local_name(each) for each in evidence.links or ((evidence.entity,) if evidence.entity else ())]
    of = f" of {' and '.join(who)}" if who else ""
    when = "" if evidence.time is None else f", {evidence.time:.4g} s into the motion"
    value, bound = told_apart(evidence.value, evidence.bound, SIGNIFICANT)
    unit, quantity = "" if evidence.unit == "1" else f" {evidence.unit}", evidence.quantity.value
    if in_the_way(quantity, pair=evidence.links is not None):
        return f"counted: {' and '.join(who)} were in the way {value} times in the search"
    over = evidence.value > evidence.bound
    beside = "" if math.isnan(evidence.bound) else f", {against(quantity, bound + unit, over=over)}"
    return f"measured: {quantity.replace('_', ' ')}{of} {value}{unit}{beside}{when}"


def versions(inputs: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Everything that the IRI is the hash of, and the budget."""
    for name, value in used(inputs):
        yield f"{name}: {value}"


def used(inputs: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    """The same as pairs of name and value, those of the embodiment without its prefix."""
    for name, value in inputs:
        if value != UNKNOWN_INPUT:
            said = unquote(value.replace(ID, "")) if ID in value else SETTINGS.sub(_settings, value)
            yield name.replace("_", " ").replace("embodiment.", ""), said


def _settings(found: re.Match[str]) -> str:
    """`Tolerances(tool_angle=0.017453292519943295)` as `tool angle 0.01745 (SI units)`."""
    pairs = (each.partition("=") for each in found[1].split(", "))
    return (
        ", ".join(f"{name.replace('_', ' ')} {float(value):.4g}" for name, _, value in pairs) + " (SI units)"
    )


def with_unit(value: float, unit: str, *, bound: bool = False) -> str:
    """A number with its unit, bare where that is 1; whether it is a lower bound."""
    return f"{AT_LEAST if bound else ''}{value:.6g}" + ("" if unit == "1" else f" {unit}")


def not_reached(rules: int) -> Iterator[str]:
    """That so many rules of a task were not judged, if any were not."""
    if rules > 0:
        yield f"{so_many(rules, 'rule was', 'rules were')} not judged: the sequence did not get there"


def margins(figures: Mapping[str, tuple[float, str]]) -> Iterator[str]:
    """Each figure of a certificate with its name; one that is a bound says so."""
    for name, value in told_figures(figures):
        yield f"{name}: {value}"


def _compared(value: object, bound: object) -> tuple[str, str]:
    """Both as text; figures that differ are told apart."""
    if isinstance(value, float) and isinstance(bound, float):
        return told_apart(value, bound, SIGNIFICANT)
    return _plain(value), _plain(bound)


def _plain(value: object) -> str:
    if value is None:
        return "none"
    if isinstance(value, float):
        return f"{value:.{SIGNIFICANT}g}"
    return local_name(value) if isinstance(value, str) and value.startswith("http") else str(value)
