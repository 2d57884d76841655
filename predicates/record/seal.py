"""A record's hash: whether a stored verdict is, triple by triple, as it was written."""

import hashlib
from collections.abc import Iterable, Sequence

import pyoxigraph as ox

from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, Iri, local_name
from sdt_kg.store import Triple, value_of

RECORD_HASH = LAW + "recordHash"
SECONDS = frozenset({LAW + "seconds", LAW + "searchedSeconds"})
"""What differs from one judging to the next is no claim, and is not sealed."""


Read = tuple[str, str, object]
"""Subject, predicate, object."""


def sealed(verdict: Iri, triples: Iterable[Triple]) -> tuple[Triple, ...]:
    """The triples of a verdict's record, and last their hash."""
    written = tuple(triples)
    return (*written, (verdict, RECORD_HASH, ox.Literal(_hash_of(written))))


def check_seal(verdict: Iri, quads: Iterable[ox.Quad]) -> None:
    """The record says what it said when it was written.

    Raises:
        InputError: A triple was added, changed or removed since.
    """
    triples = read_triples(quads)
    if not _stated(triples):
        raise InputError(
            f"the record of {local_name(verdict)} has no hash",
            allowed="a record as it was written",
            remedy="it was changed, or an earlier version wrote it: judge the case again",
        )
    check_unbroken(verdict, triples)


def check_unbroken(verdict: Iri, triples: Sequence[Read]) -> None:
    """The record says what it said when it was written, as far as it has a hash: early ones have none.

    Raises:
        InputError: A triple was added, changed or removed since.
    """
    stated, found = _stated(triples), _hash_of(triples)
    if stated and stated != [found]:
        raise InputError(
            f"the record of {local_name(verdict)} was changed after it was written: its triples have the "
            f"hash {found[:16]}…, it says {', '.join(each[:16] for each in stated)}…",
            allowed="a record as it was written",
            remedy="sdt recheck tells what of the store holds; judge the case again into another store",
        )


def read_triples(quads: Iterable[ox.Quad]) -> list[Read]:
    """The triples of a record as its hash is made of them."""
    return [(_text(quad.subject), quad.predicate.value, quad.object) for quad in quads]


def _stated(triples: Iterable[Read]) -> list[str]:
    return [_text(value) for _, predicate, value in triples if predicate == RECORD_HASH]


def _hash_of(triples: Iterable[Read]) -> str:
    """SHA-256 of all but hash and seconds; numbers count by value, for stores spell them as they like."""
    told = {
        "\t".join((subject, predicate, type(value).__name__, repr(value_of(value)), *_language(value)))
        for subject, predicate, value in triples
        if predicate != RECORD_HASH and predicate not in SECONDS
    }
    return hashlib.sha256("\n".join(sorted(told)).encode("utf-8")).hexdigest()


def _language(term: object) -> tuple[str, ...]:
    """Of a text that has one: no record is written with such, and queries tell it from the same without."""
    return (term.language,) if isinstance(term, ox.Literal) and term.language else ()


def _text(term: object) -> str:
    return str(value_of(term))
