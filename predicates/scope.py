"""Params(G) ∈ I_Φ: whether a case lies inside the TEE class D_artic."""

from predicates.case import Case, Diagnosis, Evidence, Kind, Quantity
from sdt_kg.iri import LAW, Iri, local_name
from sdt_kg.scope import D_ARTIC, Violation, violations
from sdt_kg.task import Task, Verb
from sdt_kg.twin import Container


def out_of_scope(case: Case, container: Container) -> list[Diagnosis]:
    """Why the case is outside D: one diagnosis for each SHACL result, empty inside.

    Being outside refutes nothing, so no diagnosis is a proof.
    """
    robot = case.robot if isinstance(case.robot, str) else None
    verb = verb_iri(case.task.verb) if isinstance(case.task, Task) else None
    return [_diagnosis(each) for each in violations(case.twin, container, robot, verb)]


def verb_iri(verb: Verb) -> Iri:
    """`law:Open` or `law:Close`."""
    return LAW + verb.value.capitalize()


def tee_class_hash() -> str:
    """Hash of D: its constants and shapes."""
    return D_ARTIC.content_hash()


def _diagnosis(violation: Violation) -> Diagnosis:
    """A SHACL result as a diagnosis; its numbers, where it has any, as evidence."""
    path = "" if violation.path is None else f" {local_name(violation.path)}"
    reason = f"outside D_artic: {local_name(violation.focus)}{path}: {violation.message}"
    value, bound = _number(violation.value), _number(violation.bound)
    evidence = Evidence(
        Quantity.LIMIT, value, bound, "1", entity=violation.focus, scope=D_ARTIC.name, path=violation.path
    )
    return Diagnosis(Kind.OUT_OF_SCOPE, reason, evidence, violation=violation)


def _number(value: object) -> float:
    """A number, or not-a-number where the result is about something else than a number."""
    return float(value) if isinstance(value, int | float) else float("nan")
