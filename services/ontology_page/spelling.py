"""What in a query can match nothing, since it is misspelled or not there: nothing is no "no"."""

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.errors import meant
from sdt_kg.iri import ID, LAW, OWL, PREFIXES, RDFS, SDT, TEE, Iri, local_name

_NAMESPACES: Final = {"law": LAW, "sdt": SDT, "tee": TEE}
_TERM: Final = re.compile(
    r"(?<![\w:?$-])(law|sdt|tee):([A-Za-z]\w*)|<https://example\.org/(law|sdt|tee)#(\w+)>"
)
_TEXT: Final = re.compile(r"(?<![\w:?$-])(law|sdt|tee):([A-Za-z]\w*)\s+([\"'])")
_NOT_TERMS: Final = re.compile(r"(<[^<>\s]*>)|(\"\"\"|'''|\"|')(?:\\.|(?!\2).)*\2|#[^\n]*", re.DOTALL)
"""An IRI, a text or a comment."""
_DECLARED: Final = re.compile(r"\bPREFIX\s+(\w+):\s*<([^>]*)>", re.IGNORECASE)
_ENTITY: Final = re.compile(
    r"(?<![\w:?$-])id:((?:[\w%-]|\\.|\.(?=\w))+)|<https://example\.org/id/([^>\s]*[^>\s/])>"
)
_THERE: Final = "ASK {{ {{ {0} ?p ?o }} UNION {{ ?s ?p {0} }} UNION {{ GRAPH {0} {{ ?s ?p ?o }} }} }}"

_OWN_OR_NONE: Final = (
    "ASK {{ {{ ?x a <{}> }} UNION {{ FILTER NOT EXISTS {{ VALUES ?class {{ {} }} ?y a ?class }} }} }}"
)


def matching_nothing(sparql: str, ask: Callable[[str], object]) -> Iterator[str]:
    """A sentence about all in the text that can match nothing; `ask` answers an ASK of what is queried."""
    yield from unknown_terms(sparql)
    yield from (absent for asked, absent in absences(sparql).items() if not ask(asked))


def absences(sparql: str) -> dict[str, str]:
    """An ASK for each entity and class that the text names, and a sentence for when the answer is no."""
    return entities_of(sparql) | classes_of(sparql)


def classes_of(sparql: str) -> dict[str, str]:
    """An ASK for each class with subclasses in the text, and a sentence for when only these have individuals.

    What is saved says of each individual its own classes; which class is in which, the ontology alone says.
    """
    bare, told = _without_texts(sparql), dict[str, str]()
    for prefix, name in sorted({(each[1] or each[3], each[2] or each[4]) for each in _TERM.finditer(bare)}):
        if narrower := _narrower(prefix).get(name, ()):
            iris = " ".join(f"<{_NAMESPACES[prefix]}{each}>" for each in narrower)
            values = f"VALUES ?class {{ {' '.join(f'{prefix}:{each}' for each in narrower)} }}"
            told[_OWN_OR_NONE.format(_NAMESPACES[prefix] + name, iris)] = (
                f"nothing here is said to be a {prefix}:{name}, but things are of its subclasses: ask"
                f" {values} ?x a ?class"
            )
    return told


def entities_of(sparql: str) -> dict[str, str]:
    """An ASK for each entity that the text names by `id:`, and a sentence for when the answer is no."""
    if dict(_DECLARED.findall(sparql)).get("id", ID) != ID:
        return {}
    found = (re.sub(r"\\(.)", r"\1", each[1] or "") or each[2] for each in _ENTITY.finditer(sparql))
    absent = "nothing here is called id:{}: what asks for it finds nothing, which is no 'no'"
    return {_THERE.format(f"<{ID}{name}>"): absent.format(name) for name in found}


def unknown_terms(sparql: str) -> Iterator[str]:
    """A sentence about each term of law:, sdt: or tee: in the text that the ontology does not have.

    Also about a prefix that is another here, and a text where such a term leads to an IRI.
    """
    bare = _without_texts(sparql)
    for prefix, iri in _DECLARED.findall(bare):
        if prefix in _NAMESPACES and iri != PREFIXES[prefix]:
            yield f"{prefix}: is <{PREFIXES[prefix]}> here, not <{iri}>, of which nothing is said"
    for term, hint in misspelled(sparql).items():
        yield f"{term} is no term of the ontology, and nothing has it; {hint}"
    for prefix, name, _ in dict.fromkeys(_TEXT.findall(bare)):
        if name in _leading_to_iris(prefix):
            what = f"{prefix}:{name} leads to an IRI, and no text is one"
            yield f"{what}: write id:NAME or {prefix}:NAME, without quotes"


def misspelled(sparql: str) -> dict[str, str]:
    """Each term of law:, sdt: or tee: in the text that the ontology does not have, and what may be meant."""
    bare, told = _without_texts(sparql), dict[str, str]()
    declared = dict(_DECLARED.findall(bare))
    for each in _TERM.finditer(bare):
        prefix, name = each[1] or each[3], each[2] or each[4]
        known = _names(prefix)
        if name not in known and (each[3] or declared.get(prefix, PREFIXES[prefix]) == PREFIXES[prefix]):
            near = meant(name, known)
            told[f"{prefix}:{name}"] = f"did you mean {prefix}:{near}?" if near else "sdt ontology lists them"
    return told


def _without_texts(sparql: str) -> str:
    """The query with empty texts and without comments: what they say names nothing."""
    return _NOT_TERMS.sub(lambda found: found[1] or ('""' if found[2] else ""), sparql)


@cache
def _leading_to_iris(prefix: str) -> frozenset[str]:
    """Local names of the object properties that a file of the ontology defines."""
    kind = f"{OWL}ObjectProperty"
    return frozenset(local_name(subject) for subject, _, value in _said(prefix) if value == kind)


@cache
def _narrower(prefix: str) -> dict[str, tuple[str, ...]]:
    """Local names of classes → those of all classes in them, of one file of the ontology."""
    direct: dict[str, set[str]] = {}
    for subject, predicate, value in _said(prefix):
        if predicate == f"{RDFS}subClassOf" and value.startswith(_NAMESPACES[prefix]):
            direct.setdefault(local_name(value), set()).add(local_name(subject))
    found: dict[str, tuple[str, ...]] = {}
    for name in direct:
        below, new = set[str](), {name}
        while new := {one for each in new for one in direct.get(each, ())} - below:
            below |= new
        found[name] = tuple(sorted(below))
    return found


@cache
def _names(prefix: str) -> frozenset[str]:
    """Local names of the terms that a file of the ontology defines."""
    space = _NAMESPACES[prefix]
    return frozenset(local_name(subject) for subject, _, _ in _said(prefix) if subject.startswith(space))


@cache
def _said(prefix: str) -> tuple[tuple[Iri, Iri, str], ...]:
    """Subject, predicate and value of all that a file of the ontology says."""
    data = ox.parse(ontology.path(f"{prefix}.ttl").read_bytes(), format=ox.RdfFormat.TURTLE)
    return tuple(
        (quad.subject.value, quad.predicate.value, quad.object.value)
        for quad in data
        if isinstance(quad.subject, ox.NamedNode) and isinstance(quad.object, ox.NamedNode | ox.Literal)
    )
