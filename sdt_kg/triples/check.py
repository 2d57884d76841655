"""Asserted triples of one model → its mechanism, if they are whole; a GraphError says what is not."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Final

import pyoxigraph as ox

from sdt_kg.errors import GraphError
from sdt_kg.iri import SDT, Iri, body_iri, local_name
from sdt_kg.mechanism import Mechanism
from sdt_kg.store import Triple, Value, value_of
from sdt_kg.triples.annotation import missing_of, read_kitchen, read_robot
from sdt_kg.triples.containers import torn
from sdt_kg.triples.facts import Facts
from sdt_kg.triples.from_mechanism import mechanism_triples
from sdt_kg.triples.same import Same
from sdt_kg.triples.to_mechanism import NONE, read_mechanism_of
from sdt_kg.triples.vocabulary import NUMBERS, fits, properties

_INDEX: Final = SDT + "index"


def checked_model(triples: Sequence[Triple], model: Iri, kind: str, before: Same | None = None) -> Mechanism:
    """The mechanism, if writing it again gives nothing that is not there, and its bodies form a tree.

    Args:
        triples: The model's asserted graph.
        model: Its IRI.
        kind: `Environment` or `Robot`.
        before: What is as it was in a graph that was whole: not looked at again.

    Raises:
        GraphError: A needed triple is missing, or a property is unknown, doubled or has no such value.
    """
    name = local_name(model)
    known = NONE if before is None else before.bodies
    if before is None:
        _check_parts(triples, model)
    _check_terms((each for each in triples if before is None or each[0] in before.changed), name)
    facts = Facts(triples)
    try:
        mechanism = read_mechanism_of(facts, model, known)
        read = tuple(each for each in mechanism.bodies if body_iri(name, each.name) not in known)
        unsaid = set(mechanism_triples(replace(mechanism, bodies=read), kind)).difference(triples)
        missing = missing_of(facts, model, kind)
        if not missing:
            read_robot(facts, model) if kind == "Robot" else read_kitchen(facts, model)
    except (KeyError, ValueError) as error:
        raise GraphError(f"'{name}' is not whole: {error} cannot be read") from None
    lacking = _values(unsaid, unsaid) - _values(triples, unsaid)
    lost = sorted(f"'{local_name(s)} {local_name(p)}'" for s, p, _ in lacking)
    lost += [f"'{each}'" for each in missing]
    if lost:
        raise GraphError(f"'{name}' is not whole: it lacks {lost[0]}" + _more(lost))
    _check_tree(mechanism)
    if unseen := mechanism.unseen():
        raise GraphError(f"the name {unseen} has what cannot be seen", allowed="names that can be read")
    if wrong := torn(triples, mechanism):
        raise GraphError(f"'{name}': {wrong}")
    return mechanism


def _check_parts(triples: Sequence[Triple], model: Iri) -> None:
    """Whatever is described is a part of something: a shape that no body has would be no obstacle."""
    belong = {subject for subject, predicate, _ in triples if predicate == SDT + "partOf"}
    belong |= {term.value for _, _, term in triples if isinstance(term, ox.NamedNode)}
    lost = sorted({subject for subject, _, _ in triples} - belong - {model})
    if lost:
        raise GraphError(
            f"'{local_name(model)}' is not whole: nothing has '{local_name(lost[0])}'" + _more(lost)
        )


def _values(triples: Iterable[Triple], like: Collection[Triple]) -> set[tuple[Iri, Iri, Value]]:
    """What is said of the same subjects by the same properties as in `like`.

    Numbers are taken by value: annotations may say 1 or 1.0 where a mechanism says 1.0e0. An index only
    orders, so that what is put into a scene need not number everything anew.
    """
    wanted = {(subject, predicate) for subject, predicate, _ in like if predicate != _INDEX}
    return {
        (subject, predicate, value_of(term))
        for subject, predicate, term in triples
        if (subject, predicate) in wanted
    }


def _check_terms(triples: Iterable[Triple], name: str) -> None:
    """Every sdt: property is one of `sdt.ttl`, with a value of its kind, once if it has a number."""
    numbers: set[tuple[Iri, Iri]] = set()
    for subject, predicate, term in triples:
        if not predicate.startswith(SDT):
            continue
        known = properties().get(predicate.removeprefix(SDT))
        if known is None:
            raise _term_error(subject, predicate, name, ": no such property", "those of sdt.ttl")
        if not fits(known, term):
            raise _term_error(subject, predicate, name, f" is {term}", known.value)
        if known in NUMBERS and (subject, predicate) in numbers:
            raise _term_error(subject, predicate, name, " has several values", "one")
        numbers.add((subject, predicate))


def _term_error(subject: Iri, predicate: Iri, name: str, what: str, allowed: str) -> GraphError:
    where = f"sdt:{local_name(predicate)} of '{local_name(subject)}' in '{name}'"
    return GraphError(where + what, allowed=allowed)


def _check_tree(mechanism: Mechanism) -> None:
    """The joints come parents before children, and every body but the root is one joint's child."""
    seen = {mechanism.root}
    for joint in mechanism.joints:
        if joint.parent not in seen or joint.child in seen:
            ends = f"joint '{joint.name}' from '{joint.parent}' to '{joint.child}'"
            raise GraphError(f"'{mechanism.name}' is no tree: {ends}")
        seen.add(joint.child)
    odd = sorted(seen ^ {body.name for body in mechanism.bodies})
    if odd:
        raise GraphError(f"'{mechanism.name}' is no tree: body '{odd[0]}'" + _more(odd))


def _more(found: Sequence[str]) -> str:
    return f" (and {len(found) - 1} more)" if len(found) > 1 else ""
