"""Params(G) ∈ I_Φ: whether a case lies inside a TEE class."""

from collections import defaultdict
from functools import lru_cache

import pyoxigraph as ox
import rdflib

from predicates.case import Case, Diagnosis, Evidence, Kind, Quantity
from sdt_kg.iri import LAW, RDF, SH, Iri, local_name
from sdt_kg.scope import (
    D_ARTIC,
    TASK,
    TEE_CLASSES,
    TeeClass,
    Violation,
    about_kitchen,
    check,
    shapes_about,
    violations,
)
from sdt_kg.store import Triple
from sdt_kg.task import Task, Verb
from sdt_kg.triples.to_rdflib import rdflib_graph
from sdt_kg.twin import Container, Twin

Request = tuple[Triple, ...]

_SH = rdflib.Namespace(SH)


def out_of_scope(case: Case, container: Container, tee: TeeClass = D_ARTIC) -> list[Diagnosis]:
    """Why the case is outside D: one diagnosis for each SHACL result, empty inside.

    Being outside refutes nothing, so no diagnosis is a proof.
    """
    robot = case.robot if isinstance(case.robot, str) else None
    verb = verb_iri(case.task.verb) if isinstance(case.task, Task) else None
    return [outside(each, tee) for each in violations(case.twin, container, robot, verb, tee)]


def look_at_all(twin: Twin, verb: Verb, tee: TeeClass = D_ARTIC) -> None:
    """Where requests about all containers of a kitchen are inside D, that is known of each from now on.

    One validation of all takes a third of the time of one of each. Where it does not show it, `out_of_scope`
    looks at each alone.
    """
    if tee.refined is not None:
        look_at_all(twin, verb, tee.refined)
    iri, containers = verb_iri(verb), twin.containers()
    requests = tuple(tuple(about_kitchen(twin, each, iri, tee)) for each in containers)
    if are_inside(tee, requests, shapes_about(tee, iri)):
        twin.entities.inside[tee.iri, iri] = frozenset(each.iri for each in containers)


@lru_cache(maxsize=8)
def are_inside(tee: TeeClass, requests: tuple[Request, ...], expected: tuple[Iri, ...]) -> bool:
    """Whether each request alone is shown to be inside: together they conform, and none tells of another."""
    own = tuple(
        tuple((f"{TASK}/{n}" if about == TASK else about, name, term) for about, name, term in request)
        for n, request in enumerate(requests)
    )
    whole = tuple(dict.fromkeys(triple for request in own for triple in request))
    if not all(_finds_all(tee, request, expected) for request in own) or not _apart(tee, own, whole):
        return False
    return not check(rdflib_graph(whole), tee.shapes, list(expected))


def _finds_all(tee: TeeClass, request: Request, expected: tuple[Iri, ...]) -> bool:
    """Whether every shape that is expected to finds something to look at in a request."""
    types = {term.value for _, name, term in request if name == RDF + "type"}
    names = {name for _, name, _ in request}
    return all(
        any(str(each) in types for each in tee.shapes.objects(shape, _SH["targetClass"]))
        or any(str(each) in names for each in tee.shapes.objects(shape, _SH["targetObjectsOf"]))
        for shape in map(rdflib.URIRef, expected)
    )


def _apart(tee: TeeClass, requests: tuple[Request, ...], whole: Request) -> bool:
    """Whether all requests together say no more of what one speaks of than that one alone.

    Shapes look from what they are about along properties, never against them: then each finds the same.
    """
    if (None, _SH["inversePath"], None) in tee.shapes:
        return False
    said = _grouped(whole)
    for request in requests:
        alone = _grouped(request)
        named = {term.value for _, _, term in request if isinstance(term, ox.NamedNode)}
        if any(alone.get(each) != said.get(each) for each in named.union(alone)):
            return False
    return True


def _grouped(triples: Request) -> dict[Iri, set[tuple[Iri, object]]]:
    found: defaultdict[Iri, set[tuple[Iri, object]]] = defaultdict(set)
    for about, name, term in triples:
        found[about].add((name, term))
    return found


def verb_iri(verb: Verb) -> Iri:
    """`law:Open` or `law:Close`."""
    return LAW + verb.value.capitalize()


def tee_class_hash(tee: TeeClass = D_ARTIC) -> str:
    """Hash of D: its constants and shapes."""
    return tee.content_hash


def tee_class_of_hash(found: str) -> TeeClass | None:
    """The class that has this hash; None for one of another version."""
    return next((each for each in TEE_CLASSES if each.content_hash == found), None)


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
