"""Verdicts as JSON objects, with names instead of IRIs."""

from collections.abc import Mapping
from typing import Any, Final

from predicates.case import Answer, Diagnosis, Evidence, Quantity, Verdict
from predicates.margins import NearestPair, at_least
from predicates.meant import left_parked
from predicates.scope import tee_class_of_hash
from sdt_kg.iri import local_name
from sdt_kg.motion import BodyMotion
from sdt_kg.numbers import told_apart
from sdt_kg.scope import TeeClass
from sdt_kg.task import Task

WORDS: Final = {True: "yes", False: "no", None: "not asked"}
"""What a predicate answers, for people."""

_AGAINST: Final = {
    Quantity.POSITION.value: "compared with {}",
    Quantity.DEMANDED_POSITION.value: "refuted at {}",
    Quantity.VELOCITY.value: "{} allowed",
    Quantity.ACCELERATION.value: "{} allowed",
    Quantity.COUNT.value: "{} needed",
    Quantity.LIMIT.value: "where the class has the bound {}",
    Quantity.TIME.value: "of {}",
}
"""What a bound is called beside the value of a quantity, where it is not the most that is allowed."""

SIGNIFICANT = 6
"""[digits] Figures in JSON are rounded to so many, or to as many more as tell a value from its bound."""


def answers(verdict: Verdict) -> dict[str, Answer | None]:
    """Each predicate's answer, under the name of its law: property."""
    return {
        "satisfiesRequest": verdict.satisfies_request,
        "causes": verdict.causes,
        "canPerform": verdict.can_perform,
    }


def notes(verdict: Verdict) -> tuple[str, ...]:
    """What the three answers say beyond yes and no, each sentence once."""
    found = [note for answer in answers(verdict).values() if answer is not None for note in answer.notes]
    return tuple(dict.fromkeys(found))


def figures(verdict: Verdict) -> dict[str, tuple[float, str]]:
    """Certified margins of all answers: name → (value, unit)."""
    given = [answer.figures for answer in answers(verdict).values() if answer is not None]
    return {name: figure for each in given for name, figure in each.items()}


def nearest_pairs(verdict: Verdict) -> dict[str, NearestPair]:
    """Of these, name of a smallest distance → between which two bodies it is, and when."""
    given = [answer.nearest_pairs for answer in answers(verdict).values() if answer is not None]
    return {name: pair for each in given for name, pair in each.items()}


def times(verdict: Verdict) -> dict[str, float]:
    """Seconds of each step of all answers."""
    given = [answer.seconds for answer in answers(verdict).values() if answer is not None]
    return {name: seconds for each in given for name, seconds in each.items()}


def gripper(verdict: Verdict) -> str | None:
    """Name of the gripper that acts, where one was found or given."""
    motion = verdict.case.body_motion
    return (motion.gripper or None) if isinstance(motion, BodyMotion) else None


def drive(verdict: Verdict) -> str | None:
    """How the base moves, where an embodiment was asked; else as the robot's hardware does."""
    settings = dict(verdict.inputs)
    if "embodiment.drive" in settings:
        return settings["embodiment.drive"]
    robot = verdict.case.robot
    return verdict.case.twin.robot(robot).drive.value if isinstance(robot, str) else None


def tee_class(verdict: Verdict) -> TeeClass | None:
    """The class D that the verdict is relative to; None for one of another version."""
    return tee_class_of_hash(dict(verdict.inputs).get("tee_class", ""))


def moved(verdict: Verdict) -> dict[str, float]:
    """Joints that are not where the kitchen starts → where they are at first [rad or m]."""
    twin = verdict.case.twin
    start = twin.entities.coupling.start()
    return {local_name(joint): at for joint, at in sorted(twin.state.items()) if at != start[joint]}


def to_json(verdict: Verdict) -> dict[str, object]:
    """The object that `sdt achieve --json` prints.

    Of its figures `at_least` names those that are bounds, and `nearest` says of the other smallest distances
    between which two bodies they are. `parked` are joints of the acting gripper's chain that the body motion
    does not list.
    """
    case = verdict.case
    task = case.task if isinstance(case.task, Task) else None
    container = task.container if task is not None and isinstance(task.container, str) else None
    tee = tee_class(verdict)
    holds = {name: None if answer is None else answer.holds for name, answer in answers(verdict).items()}
    return {
        "kitchen": local_name(case.twin.environment),
        "robot": local_name(case.robot) if isinstance(case.robot, str) else None,
        "task": task.verb.value if task is not None else None,
        "container": local_name(container) if container is not None else None,
        "state": moved(verdict),
        "outcome": verdict.outcome.value,
        "satisfies_request": holds["satisfiesRequest"],
        "causes": holds["causes"],
        "can_perform": holds["canPerform"],
        "gripper": gripper(verdict),
        "drive": drive(verdict),
        "parked": [local_name(each) for each in left_parked(case)],
        "tee_class": None if tee is None else tee.name,
        "diagnoses": [diagnosis_json(each) for each in verdict.diagnoses],
        "figures": {name: [_rounded(value), unit] for name, (value, unit) in figures(verdict).items()},
        "at_least": list(at_least(figures(verdict))),
        "nearest": {name: pair_json(pair) for name, pair in nearest_pairs(verdict).items()},
        "notes": list(notes(verdict)),
        "times": {name: round(seconds, 4) for name, seconds in times(verdict).items()},
        "seconds": round(verdict.seconds, 4),
        "stored": verdict.stored,
        "iri": verdict.iri,
    }


def pair_json(pair: NearestPair) -> dict[str, object]:
    """Names of the two bodies, and the time along the motion [s]."""
    return {"links": [local_name(link) for link in pair.links], "time": _rounded(pair.time)}


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, object]:
    """A diagnosis as a JSON object."""
    search = diagnosis.search
    return {
        "kind": diagnosis.kind.value,
        "code": None if diagnosis.code is None else diagnosis.code.value,
        "reason": diagnosis.reason,
        "evidence": None if diagnosis.evidence is None else _evidence_json(diagnosis.evidence),
        "proof": diagnosis.proof,
        "search": None
        if search is None
        else {
            "seeds": search.seeds,
            "branches": search.branches,
            "placements": search.placements,
            "seconds": round(search.seconds, 4),
        },
    }


def _evidence_json(evidence: Evidence) -> dict[str, object]:
    """Evidence with what it has: an entity or two links, a time, a scope, a path."""
    value, bound = map(float, told_apart(evidence.value, evidence.bound, SIGNIFICANT))
    found: dict[str, object] = {
        "quantity": evidence.quantity.value,
        "value": _finite(value),
        "bound": _finite(bound),
        "unit": evidence.unit,
        "time": None if evidence.time is None else _rounded(evidence.time),
    }
    if evidence.links is not None:
        found["links"] = [local_name(link) for link in evidence.links]
    if evidence.entity is not None:
        found["entity"] = local_name(evidence.entity)
    if evidence.scope:
        found["scope"] = evidence.scope
    if evidence.path is not None:
        found["path"] = local_name(evidence.path)
    return found


def evidence_line(evidence: Mapping[str, Any], unknown: str) -> str:
    """What was measured of what, and when, of evidence as `diagnosis_json` has it.

    Empty of a class's limit where there is no number: too few values, too many, or one of another kind, which
    the reason says.
    """
    if evidence["quantity"] == Quantity.LIMIT.value and evidence["value"] is None:
        return ""
    quantity, links = evidence["quantity"].replace("_", " "), evidence.get("links", [])
    who = " and ".join(links) or evidence.get("entity", "")
    when = "" if evidence["time"] is None else f", at {evidence['time']:g} s"
    if in_the_way(evidence["quantity"], pair=bool(links)):
        return f"{who}: {told_evidence(evidence, unknown)}"
    what = evidence.get("path", quantity)
    return f"{what} of {who}: {told_evidence(evidence, unknown)}{when}"


def told_evidence(evidence: Mapping[str, Any], unknown: str) -> str:
    """Value and bound of evidence as `diagnosis_json` has it; `unknown` where there is no value."""
    unit = "" if evidence["unit"] == "1" else f" {evidence['unit']}"
    value, bound, quantity = evidence["value"], evidence["bound"], evidence["quantity"]
    if value is not None and in_the_way(quantity, pair="links" in evidence):
        return f"in the way {value:g} times in the search"
    if bound is None:
        return unknown if value is None else f"{value:g}{unit}"
    if value is None:
        return f"{unknown}, {against(quantity, f'{bound:g}{unit}')}"
    told, demanded = told_apart(value, bound, SIGNIFICANT)
    return f"{told}{unit}, {against(quantity, demanded + unit, over=value > bound)}"


def in_the_way(quantity: str, *, pair: bool) -> bool:
    """Whether it counts how often two bodies were too near to each other in a search."""
    return pair and quantity == Quantity.COUNT.value


def against(quantity: str, bound: str, *, over: bool = False) -> str:
    """What a bound is, in words that say for what: of a quantity that is above it, or not."""
    if quantity == Quantity.DISTANCE.value and not over:
        return f"at least {bound} needed"
    return _AGAINST.get(quantity, "at most {} allowed").format(bound)


def _rounded(value: float) -> float | None:
    """The value to SIGNIFICANT digits."""
    return _finite(float(f"{value:.{SIGNIFICANT}g}"))


def _finite(value: float) -> float | None:
    """JSON has no infinity and no NaN, which become null."""
    return value if abs(value) < float("inf") else None
