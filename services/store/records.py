"""Records of verdicts and of tasks' results in a store: one of each, and the better of two."""

import pyoxigraph as ox

from predicates.record import Record, gives_way
from predicates.specification.record import gives_way as result_gives_way
from sdt_kg.iri import Iri, graph_iri, local_name, task_result_iri
from services.store.quads import QuadStore


def keep(store: QuadStore, record: Record) -> bool:
    """Whether the store has changed: a record that is there stays, unless it gives way to this one."""
    fresh = list(record.quads())
    with store.alone(record.graph):
        stored = store.graph(record.graph)
        if not is_kept(stored, fresh, record.verdict):
            return False
        if stored:
            store.replace(record.graph, fresh)
        else:
            store.add(fresh)
    return True


def is_kept(stored: list[ox.Quad], fresh: list[ox.Quad], iri: Iri) -> bool:
    """Whether a record goes where these quads are stored: nothing, or what gives way to it."""
    if not stored:
        return True
    return result_gives_way(stored, fresh, iri) if is_result(iri) else gives_way(stored, fresh)


def is_result(iri: Iri) -> bool:
    """Whether a record is the result of a task specification, not a verdict."""
    return iri.startswith(task_result_iri(""))


def graph_of(iri: Iri) -> Iri:
    """Named graph of a verdict, or of the result of a task specification."""
    return graph_iri("task_result" if is_result(iri) else "verdict", local_name(iri))
