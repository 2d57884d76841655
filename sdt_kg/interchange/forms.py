"""A twin's graphs in a store, and as RDF in one of its forms."""

from collections.abc import Iterable
from typing import Final

import pyoxigraph as ox

from sdt_kg.iri import PREFIXES

Quads = ox.Store | Iterable[ox.Quad]

FORMS: Final = {
    "turtle": ox.RdfFormat.TURTLE,
    "trig": ox.RdfFormat.TRIG,
    "nquads": ox.RdfFormat.N_QUADS,
}


def stored(quads: Quads) -> ox.Store:
    """The quads in a store; a store is itself."""
    if isinstance(quads, ox.Store):
        return quads
    store = ox.Store()
    store.extend(quads)
    return store


def dumped(store: ox.Store, form: str) -> bytes:
    """The store as `turtle` (all graphs merged), `trig` or `nquads` (named graphs)."""
    if form != "turtle":
        found = store.dump(format=FORMS[form], prefixes=PREFIXES if form == "trig" else None)
    else:
        triples = {ox.Triple(quad.subject, quad.predicate, quad.object) for quad in store}
        found = ox.serialize(sorted(triples, key=str), format=FORMS[form], prefixes=PREFIXES)
    assert found is not None, "without an output, the bytes are returned"
    return found
