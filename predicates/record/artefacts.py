"""Artefacts in the graph: what re-verifies a verdict, with the hash of its bytes."""

import base64
import binascii
import hashlib
from collections.abc import Iterator

import pyoxigraph as ox

from predicates.case import Artefact, ArtefactKind, Verdict
from predicates.record.report import answers
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, RDF, XSD, Iri, graph_iri, local_name, part_iri
from sdt_kg.store import Triple, value_of

_BASE_64 = ox.NamedNode(XSD + "base64Binary")


def artefact_of(verdict: Verdict) -> Artefact | None:
    """The verdict's artefact, of whichever answer has one; CanPerform's before the others."""
    given = [answer.artefact for answer in answers(verdict).values() if answer is not None]
    return next((each for each in reversed(given) if each is not None), None)


def artefact_triples(verdict: Verdict) -> Iterator[Triple]:
    """The artefact, if there is one, as an individual of its own: kind, hash, bytes."""
    artefact = artefact_of(verdict)
    if artefact is None:
        return
    of = part_iri(verdict.iri, "artefact", 1)
    content = base64.b64encode(artefact.content).decode("ascii")
    yield verdict.iri, LAW + "artefact", ox.NamedNode(of)
    yield of, RDF + "type", ox.NamedNode(LAW + "Artefact")
    yield of, LAW + "artefactKind", ox.Literal(artefact.kind.value)
    yield of, LAW + "contentHash", ox.Literal(hashlib.sha256(artefact.content).hexdigest())
    yield of, LAW + "content", ox.Literal(content, datatype=_BASE_64)


def read_artefact(store: ox.Store, verdict: Iri) -> Artefact | None:
    """The artefact of a stored verdict; None if it has none.

    Raises:
        InputError: It is damaged: a part is missing, given twice, or the bytes have another hash.
    """
    graph = ox.NamedNode(graph_iri("verdict", local_name(verdict)))
    of = part_iri(verdict, "artefact", 1)
    named = store.quads_for_pattern(ox.NamedNode(verdict), ox.NamedNode(LAW + "artefact"), None, graph)
    if not list(named):
        return None
    kind, stated, content = (
        _one(store, graph, of, name) for name in ("artefactKind", "contentHash", "content")
    )
    try:
        artefact = Artefact(ArtefactKind(kind), base64.b64decode(content, validate=True))
    except binascii.Error as error:
        raise InputError(f"the artefact of {local_name(verdict)} is damaged: {error}") from None
    except ValueError:
        allowed = " or ".join(each.value for each in ArtefactKind)
        raise InputError(f"an artefact of the kind '{kind}'", allowed=allowed) from None
    found = hashlib.sha256(artefact.content).hexdigest()
    if found != stated:
        raise InputError(
            f"the artefact of {local_name(verdict)} is damaged: its bytes have the hash {found[:16]}…",
            allowed=f"{stated[:16]}…, as its verdict says",
        )
    return artefact


def _one(store: ox.Store, graph: ox.NamedNode, of: Iri, name: str) -> str:
    pattern = store.quads_for_pattern(ox.NamedNode(of), ox.NamedNode(LAW + name), None, graph)
    values = [str(value_of(quad.object)) for quad in pattern]
    if len(values) != 1:
        raise InputError(f"the artefact {of} has {len(values)} values of law:{name}", allowed="one")
    return values[0]
