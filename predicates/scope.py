"""Params(G) ∈ I_Φ: whether a case lies inside a TEE class."""

from collections.abc import Iterable
from dataclasses import replace

from predicates.case import Case, Diagnosis, Evidence, Kind, Quantity
from sdt_kg.iri import LAW, Iri, local_name
from sdt_kg.scope import D_ARTIC, TEE_CLASSES, TeeClass, violations
from sdt_kg.shacl import Violation
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container


def out_of_scope(case: Case, container: Container, tee: TeeClass = D_ARTIC) -> list[Diagnosis]:
    """Why the case is outside D: one diagnosis for each SHACL result, empty inside.

    Being outside refutes nothing, so no diagnosis is a proof.
    """
    robot = case.robot if isinstance(case.robot, str) else None
    verb = verb_iri(case.task.verb) if isinstance(case.task, Task) else None
    return [outside(each, tee) for each in violations(case.twin, container, robot, verb, tee)]


def verb_iri(verb: Verb) -> Iri:
    """`law:Open` or `law:Close`."""
    return LAW + verb.value.capitalize()


def tee_class_hash(tee: TeeClass = D_ARTIC) -> str:
    """Hash of D: its constants and shapes."""
    return tee.content_hash


def tee_class_of_hash(found: str) -> TeeClass | None:
    """The class that has this hash; None for one of another version."""
    return next((each for each in TEE_CLASSES if each.content_hash == found), None)


def claimed(diagnoses: Iterable[Diagnosis]) -> tuple[Diagnosis, ...]:
    """The reasons; beside one that is out of scope none is a proof, since nothing is claimed there."""
    found = tuple(diagnoses)
    outside = any(each.kind is Kind.OUT_OF_SCOPE for each in found)
    return tuple(replace(each, proof=False) for each in found) if outside else found


def outside(violation: Violation, tee: TeeClass) -> Diagnosis:
    """A SHACL result as a diagnosis; its numbers, where it has any, as evidence."""
    path = "" if violation.path is None else f" {local_name(violation.path)}"
    reason = f"outside {tee.name}: {local_name(violation.focus)}{path}: {violation.message}"
    value, bound = _number(violation.value), _number(violation.bound)
    evidence = Evidence(
        Quantity.LIMIT, value, bound, "1", entity=violation.focus, scope=tee.name, path=violation.path
    )
    return Diagnosis(Kind.OUT_OF_SCOPE, reason, evidence, violation=violation)


def _number(value: object) -> float:
    """A number, or not-a-number where the result is about something else than a number."""
    return float(value) if isinstance(value, int | float) else float("nan")
