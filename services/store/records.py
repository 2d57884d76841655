"""Records of verdicts and of tasks' results in a store: one of each, and the better of two."""

import logging
from collections.abc import Iterable, Iterator

import pyoxigraph as ox

from predicates.record import Record, StoredVerdict, gives_way, read_verdict, verdict_records
from predicates.record.recall import check_coherent
from predicates.record.seal import check_unbroken, read_triples
from predicates.specification.record import gives_way as result_gives_way
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, Iri, graph_iri, local_name, task_result_iri
from services.store.quads import QuadStore

SET_ASIDE = ox.NamedNode(LAW + "setAside")
_log = logging.getLogger("sdt.store")


def keep(store: QuadStore, record: Record) -> bool:
    """Whether the store has changed: a record that is there stays, unless it gives way to this one.

    One that is damaged is set aside first, as text: nothing of it is lost, and it claims nothing.
    """
    fresh = list(record.quads())
    with store.alone(record.graph):
        stored = store.graph(record.graph)
        if not is_kept(stored, fresh, record.verdict):
            return False
        if stored and damage(stored, record.verdict):
            store.add([_aside(stored, record.verdict)])
        if stored:
            store.replace(record.graph, fresh)
        else:
            store.add(fresh)
    return True


def is_kept(stored: list[ox.Quad], fresh: list[ox.Quad], iri: Iri) -> bool:
    """Whether a record goes where these quads are stored: nothing, or what gives way to it."""
    if not stored or damage(stored, iri):
        return True
    return result_gives_way(stored, fresh, iri) if is_result(iri) else gives_way(stored, fresh)


def recalled(quads: Iterable[ox.Quad], iri: Iri) -> StoredVerdict | None:
    """The verdict of this record; None without quads, and where it is damaged, which is logged."""
    written = list(quads)
    if not written:
        return None
    try:
        return _sound(written, iri)
    except InputError as error:
        _log.warning("%s; it does not count, and the case is judged anew", error.what)
        return None


def all_recalled(store: ox.Store) -> tuple[list[StoredVerdict], dict[Iri, str]]:
    """Every verdict of a store, by IRI, and of those that are damaged, what is wrong."""
    sound: list[StoredVerdict] = []
    damaged: dict[Iri, str] = {}
    for iri, record in verdict_records(store):
        try:
            sound.append(_sound(record, iri))
        except InputError as error:
            damaged[iri] = error.what
    return sound, damaged


def damage(quads: Iterable[ox.Quad], iri: Iri) -> str:
    """Why the record of a verdict is not as it was written; empty if it is, and of a result of a task."""
    if is_result(iri):
        return ""
    try:
        _sound(quads, iri)
    except InputError as error:
        return error.what
    return ""


def changed_since(store: ox.Store) -> Iterator[tuple[Iri, str]]:
    """Graphs of verdicts that do not fit the hash of their record, each with what is wrong."""
    for graph in store.named_graphs():
        name = graph.value if isinstance(graph, ox.NamedNode) else ""
        if name.startswith(graph_iri("verdict", "")):
            try:
                check_unbroken(name, read_triples(store.quads_for_pattern(None, None, None, graph)))
            except InputError as error:
                yield name, error.what


def is_result(iri: Iri) -> bool:
    """Whether a record is the result of a task specification, not a verdict."""
    return iri.startswith(task_result_iri(""))


def graph_of(iri: Iri) -> Iri:
    """Named graph of a verdict, or of the result of a task specification."""
    return graph_iri("task_result" if is_result(iri) else "verdict", local_name(iri))


def _sound(quads: Iterable[ox.Quad], iri: Iri) -> StoredVerdict:
    """The verdict, whose record is as it was written and does not contradict itself."""
    stored = read_verdict(quads, iri)
    check_coherent(stored)
    return stored


def _aside(quads: Iterable[ox.Quad], iri: Iri) -> ox.Quad:
    """The text of a record, in a graph of its own."""
    text = "".join(sorted(f"{quad} .\n" for quad in quads))
    graph = graph_iri("set_aside", local_name(iri))
    return ox.Quad(ox.NamedNode(iri), SET_ASIDE, ox.Literal(text), ox.NamedNode(graph))
