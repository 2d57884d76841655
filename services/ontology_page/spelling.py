"""Terms of the ontology in a query that are none: they match nothing, and nothing is no "no"."""

import re
from collections.abc import Iterator
from functools import cache
from typing import Final

import pyoxigraph as ox

import ontology
from sdt_kg.errors import meant
from sdt_kg.iri import LAW, SDT, TEE, local_name

_NAMESPACES: Final = {"law": LAW, "sdt": SDT, "tee": TEE}
_TERM: Final = re.compile(
    r"(?<![\w:?$-])(law|sdt|tee):([A-Za-z]\w*)|<https://example\.org/(law|sdt|tee)#(\w+)>"
)


def unknown_terms(sparql: str) -> Iterator[str]:
    """A sentence about each term of law:, sdt: or tee: in the text that the ontology does not have."""
    found = dict.fromkeys((each[1] or each[3], each[2] or each[4]) for each in _TERM.finditer(sparql))
    for prefix, name in found:
        known = _names(prefix)
        if name not in known:
            near = meant(name, known)
            hint = f"did you mean {prefix}:{near}?" if near else "sdt ontology lists them"
            yield f"{prefix}:{name} is no term of the ontology, and nothing has it; {hint}"


@cache
def _names(prefix: str) -> frozenset[str]:
    """Local names of the terms that a file of the ontology defines."""
    subjects = (
        quad.subject.value
        for quad in ox.parse(ontology.path(f"{prefix}.ttl").read_bytes(), format=ox.RdfFormat.TURTLE)
        if isinstance(quad.subject, ox.NamedNode)
    )
    return frozenset(local_name(each) for each in subjects if each.startswith(_NAMESPACES[prefix]))
