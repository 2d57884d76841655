"""What is said of the smallest change that turns a verdict: as JSON, and how sure it is in words."""

from typing import Any

from sdt_kg.load import model_name
from services.codesign.entries import Found
from services.codesign.smallest.sought import Sought, Trial, Turned

Json = dict[str, Any]  # JSON object


def turned_json(found: Turned) -> Json:
    """The object that `sdt whatif --turn --json` prints where no edit is named; models by their names."""
    return {
        "kitchen": model_name(found.question.kitchen),
        "robot": model_name(found.question.robot),
        "task": found.question.task,
        "actual": _found_json(found.actual),
        "families": [_sought_json(each, found.actual) for each in found.sought],
        "seconds": round(found.seconds, 3),
        "cpu_seconds": round(found.cpu_seconds, 3),
    }


def _found_json(found: Found) -> Json:
    """An outcome with its predicates and reasons."""
    return {
        "iri": found.iri,
        "outcome": None if found.outcome is None else found.outcome.value,
        "holds": found.holds,
        "diagnoses": list(found.diagnoses),
    }


def _sought_json(one: Sought, actual: Found) -> Json:
    said: Json = {
        "family": one.family.name,
        "found": one.turn is not None,
        "edit": None if one.turn is None else one.turn.edit,
        "not_yet": None if one.not_yet is None else one.not_yet.edit,
        "verdict": None if one.turn is None else _found_json(one.turn.found),
        "differs": None if one.turn is None else _contrast(actual, one.turn.found),
        "sure": sure(one),
        "range": one.family.range,
        "resolution": one.family.resolution,
        "looked_at": _looked_json(one) if one.family.scan else None,
        "stopped": one.stopped and not one.is_complete,
        "impossible": one.impossible,
    }
    said["tried"] = [
        {"edit": each.edit, "outcome": _outcome(each), "proved": each.is_proved} for each in one.tried
    ]
    return said


def _looked_json(one: Sought) -> Json:
    """Of gradual edits: which smaller ones were tried, the answer being minimal among them [m]."""
    return {
        "up_to": _metres(one.reach * one.family.longest),
        "apart_at_most": _metres(one.gap),
        "apart_in_its_direction": _metres(one.own_gap),
        "tolerance": one.family.finest,
        "complete": one.is_complete,
        "smaller_tried": len(one.smaller),
        "smaller_proved": sum(each.is_proved for each in one.smaller),
    }


def _metres(length: float) -> float:
    return round(length, 4)


def _outcome(trial: Trial) -> str:
    return "no such world" if trial.found.outcome is None else trial.found.outcome.value


def _contrast(actual: Found, other: Found) -> Json:
    """Predicates that answer otherwise, and the reasons that are gone or new."""
    reasons = [{(each["kind"], each["reason"]) for each in one.diagnoses} for one in (actual, other)]
    return {
        "predicates": [
            {"predicate": name, "actual": before, "counterfactual": other.holds.get(name)}
            for name, before in actual.holds.items()
            if before is not other.holds.get(name)
        ],
        "no_longer": [each for each in actual.diagnoses if (each["kind"], each["reason"]) not in reasons[1]],
        "now": [each for each in other.diagnoses if (each["kind"], each["reason"]) not in reasons[0]],
    }


def sure(one: Sought) -> str:
    """How sure the answer of a family is, in words."""
    if one.impossible:
        return f"not possible here: {one.impossible}"
    if one.turn is not None:
        basis = _basis(one.turn.found)
        return f"{basis}; {_looked_at(one)}" if one.family.scan else basis
    if one.is_proved:
        return "proved: each is refused by a proof"
    if one.family.scan:
        return f"searched, not proved; {_looked_at(one)}"
    return "searched, not proved" + ("; the time ended before all was tried" if one.stopped else "")


def _looked_at(one: Sought) -> str:
    """Of gradual edits: which smaller ones were tried, and how far they are apart."""
    count, proved = len(one.smaller), sum(each.is_proved for each in one.smaller)
    if one.turn is not None and not count:
        return f"nothing smaller was tried, nothing is said below {one.gap:.2g} m"
    finest, smaller = one.family.finest, "" if one.turn is None else "smaller "
    wide = f"at most {one.own_gap:.2g} m apart" + (
        f" in its direction and {one.gap:.2g} m in others" if one.own_gap < one.gap else ""
    )
    apart = f"{count} {smaller}sizes tried, {wide}, turn nothing"
    apart += f" ({proved} by proof)" if proved else ""
    return apart if one.is_complete else f"{apart}; the time ended before {finest} m"


def _basis(found: Found) -> str:
    """What the outcome after a turn rests on."""
    return found.basis or ("certified" if found.is_certified else "outside the class")
