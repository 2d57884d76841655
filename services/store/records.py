"""Records of verdicts and of tasks' results in a store: one of each, and the better of two."""

import logging
from collections.abc import Iterable, Iterator, Sequence

import pyoxigraph as ox

from predicates.record import Record, StoredVerdict, gives_way, read_verdict, verdict_records, verdicts_of
from predicates.record.recall import check_coherent
from predicates.record.seal import check_seal
from predicates.specification.results.record import gives_way as result_gives_way
from predicates.specification.results.stored import read_result, results_of
from sdt_kg.errors import InputError
from sdt_kg.iri import LAW, Iri, graph_iri, local_name, task_result_iri
from services.store.quads import QuadStore
from services.versions import outdated

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
    """Every verdict of a store, by IRI, and what is wrong with records, also of tasks, that are damaged."""
    sound: list[StoredVerdict] = []
    damaged: dict[Iri, str] = {}
    for iri, record in verdict_records(store):
        try:
            sound.append(_sound(list(record), iri))
        except InputError as error:
            damaged[iri] = error.what
    for iri in results_of(store):
        if why := damage(_record(store, iri), iri):
            damaged[iri] = why
    return sound, damaged


def damage(quads: Iterable[ox.Quad], iri: Iri) -> str:
    """Why the record of a verdict, or of a result of a task, is not as it was written; empty if it is."""
    written = list(quads)
    try:
        if is_result(iri):
            read_result(written, iri)
        else:
            _sound(written, iri)
    except InputError as error:
        return error.what
    return ""


def changed_since(store: ox.Store) -> Iterator[tuple[Iri, str]]:
    """Graphs of verdicts and results of tasks that are not as they were written, each with what is wrong."""
    for iri in (*verdicts_of(store), *results_of(store)):
        quads = _record(store, iri)
        if not _fits(quads, iri) and (why := damage(quads, iri)):
            yield graph_of(iri), why


def _record(store: ox.Store, iri: Iri) -> list[ox.Quad]:
    return list(store.quads_for_pattern(None, None, None, ox.NamedNode(graph_of(iri))))


def _fits(quads: Sequence[ox.Quad], iri: Iri) -> bool:
    """Whether a record has its hash and says to be what it is: a quarter of the time of reading it."""
    kind = ox.NamedNode(LAW + ("TaskResult" if is_result(iri) else "Verdict"))
    if not any((quad.subject, quad.object) == (ox.NamedNode(iri), kind) for quad in quads):
        return False
    try:
        check_seal(iri, quads)
    except InputError:
        return False
    return True


def is_result(iri: Iri) -> bool:
    """Whether a record is the result of a task specification, not a verdict."""
    return iri.startswith(task_result_iri(""))


def graph_of(iri: Iri) -> Iri:
    """Named graph of a verdict, or of the result of a task specification."""
    return graph_iri("task_result" if is_result(iri) else "verdict", local_name(iri))


def _sound(quads: Sequence[ox.Quad], iri: Iri) -> StoredVerdict:
    """The verdict, whose record is as it was written and does not contradict itself.

    Versions before records had a hash wrote them without; from who judges now there is none without.
    """
    stored = read_verdict(quads, iri)
    check_coherent(stored)
    if not outdated(dict(stored.inputs)):
        check_seal(iri, quads)
    return stored


def _aside(quads: Iterable[ox.Quad], iri: Iri) -> ox.Quad:
    """The text of a record, in a graph of its own."""
    text = "".join(sorted(f"{quad} .\n" for quad in quads))
    graph = graph_iri("set_aside", local_name(iri))
    return ox.Quad(ox.NamedNode(iri), SET_ASIDE, ox.Literal(text), ox.NamedNode(graph))
