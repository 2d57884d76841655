"""States of a kitchen as graphs beside its entities, and what was asked of them."""

import hashlib
from collections import OrderedDict
from collections.abc import Sequence
from threading import Lock
from typing import Final

from sdt_kg.entities.queries import query_text
from sdt_kg.iri import SDT, Iri, graph_iri, local_name
from sdt_kg.state import State
from sdt_kg.store import Row, Store, Value, double, rows_of, term_of

KEPT_STATES: Final = 256
"""State graphs that a store keeps at a time; a dropped one is written again when asked for."""

KEPT_ANSWERS: Final = 4096
"""Answers that are kept at a time."""


class States:
    """The states of one kitchen in the store that holds its entities.

    Args:
        store: Holds the entity graphs, and gets those of states.
        environment: The kitchen.
        entities: The entity graphs.
    """

    def __init__(self, store: Store, environment: Iri, entities: Sequence[Iri]) -> None:
        self._store, self._environment, self._entities = store, environment, entities
        self._written: OrderedDict[State, Iri] = OrderedDict()
        self._answers: dict[tuple[object, ...], bool] = {}
        self._lock = Lock()

    def __reduce__(self) -> tuple[type["States"], tuple[Store, Iri, Sequence[Iri]]]:
        """Of the same store; a state that it has is written again when asked for, which changes nothing."""
        return States, (self._store, self._environment, self._entities)

    def graphs(self, state: State) -> tuple[Iri, ...]:
        """Entity graphs, then the state's, written when first asked for; the oldest of many are dropped."""
        with self._lock:
            if state in self._written:
                self._written.move_to_end(state)
                return (*self._entities, self._written[state])
            graph = state_iri(self._environment, state)
            positions = ((joint, SDT + "position", double(value)) for joint, value in state.positions)
            self._store.add(graph, positions)
            self._written[state] = graph
            if len(self._written) > KEPT_STATES:
                self._store.drop(self._written.popitem(last=False)[1])
            return (*self._entities, graph)

    def rows(self, state: State, query: str, **known: Value) -> list[Row]:
        """Rows of a query of `ontology/queries`, by its file's stem, over [entities, state]."""
        bound = {name: term_of(value) for name, value in known.items()}
        return rows_of(self._store.query(query_text(query), self.graphs(state), bound))[1]

    def has_row(self, state: State, query: str, **known: Value) -> bool:
        """Whether such a query has a row; kept, since neither entities nor a state ever change."""
        asked = (state, query, *sorted(known.items()))
        if asked not in self._answers:
            if len(self._answers) >= KEPT_ANSWERS:
                self._answers.clear()
            self._answers[asked] = bool(self.rows(state, query, **known))
        return self._answers[asked]


def state_iri(environment: Iri, state: State) -> Iri:
    """Named graph of a state: the hash of its positions."""
    digest = hashlib.sha256(repr(state.positions).encode()).hexdigest()
    return graph_iri("state", f"{local_name(environment)}/{digest[:16]}")
