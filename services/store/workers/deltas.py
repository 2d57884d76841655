"""Changes of what is served, applied alike where the data is held and in every worker.

The default graph is kept as the merge of those named graphs that hold now: entities, present states,
verdicts, observations. Graphs of other states and branches are there only by name. Merged once when
written, it costs memory and makes a query over thousands of graphs as fast as over one.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

import pyoxigraph as ox

from sdt_kg.iri import Iri
from services.store.workers.frames import Head

DEFAULT_GRAPH: Final = ""
"""Stands for the default graph where the IRI of a graph is asked for."""

LARGE: Final = 2**24
"""[bytes] More is loaded in bulk, which is fast and sets 200 MB aside."""


@dataclass(frozen=True, slots=True)
class Delta:
    """One change.

    Attributes:
        head: What to do, as JSON.
        body: Triples or quads.
    """

    head: Head
    body: bytes = field(default=b"", repr=False)


def put(
    graph: Iri,
    triples: bytes,
    *,
    shown: bool = True,
    instead: bool = False,
    turned: tuple[Iri, Iri] | None = None,
) -> Delta:
    """Add N-Triples to a graph, or put them there `instead` of what it has; an empty graph then exists.

    Args:
        graph: Its name.
        triples: N-Triples.
        shown: They are put into the default graph too.
        instead: Nothing else is in the graph.
        turned: Graphs of which the first is in the default graph from then on, and the second only by name:
            no query sees both, or neither.
    """
    said = {"do": "put", "graph": graph, "shown": shown, "instead": instead, "turned": turned}
    return Delta(said, triples)


def bulk(quads: bytes, apart: Iterable[Iri] = ()) -> Delta:
    """Add N-Quads; all but the graphs `apart` are in the default graph too."""
    return Delta({"do": "bulk", "apart": list(apart)}, quads)


def drop(graph: Iri) -> Delta:
    """Remove a graph, from the default graph too."""
    return Delta({"do": "drop", "graph": graph})


class Held:
    """A store with its merged default graph."""

    def __init__(self) -> None:
        self.store = ox.Store()
        self._shown: set[Iri] = set()

    def apply(self, delta: Delta) -> None:
        """The change is made.

        Raises:
            SyntaxError: The body is not RDF.
        """
        getattr(self, f"_{delta.head['do']}")(delta)

    def is_graph(self, graph: Iri) -> bool:
        """Whether there is such a named graph."""
        return self.store.contains_named_graph(ox.NamedNode(graph))

    def _put(self, delta: Delta) -> None:
        graph = delta.head["graph"]
        if graph == DEFAULT_GRAPH:
            self._load(delta.body, None)
            return
        node = ox.NamedNode(graph)
        list(ox.parse(delta.body, format=ox.RdfFormat.N_TRIPLES))  # before anything is lost
        if delta.head["instead"]:
            self._drop(delta)
        self._load(delta.body, node)
        self.store.add_graph(node)
        if delta.head["shown"]:
            self._shown.add(graph)
            self._load(delta.body, None)
        if delta.head["turned"]:
            after, before = delta.head["turned"]
            self._merge(ox.NamedNode(after))
            if after != before:
                self._hide(before)

    def _load(self, triples: bytes, graph: ox.NamedNode | None) -> None:
        self.store.load(triples, format=ox.RdfFormat.N_TRIPLES, to_graph=graph)

    def _bulk(self, delta: Delta) -> None:
        apart = set(delta.head["apart"])
        if len(delta.body) > LARGE and not len(self.store):
            self._fill(delta.body, apart)
            return
        load = self.store.bulk_load if len(delta.body) > LARGE else self.store.load
        load(delta.body, format=ox.RdfFormat.N_QUADS)
        for graph in {quad.graph_name for quad in ox.parse(delta.body, format=ox.RdfFormat.N_QUADS)}:
            if isinstance(graph, ox.NamedNode) and graph.value not in apart:
                self._merge(graph)

    def _fill(self, quads: bytes, apart: set[Iri]) -> None:
        """Much into an empty store, merged in one go."""
        self.store.bulk_load(quads, format=ox.RdfFormat.N_QUADS)
        names = {graph.value for graph in self.store.named_graphs() if isinstance(graph, ox.NamedNode)}
        self._shown = names - apart
        hidden = ", ".join(str(ox.NamedNode(graph)) for graph in sorted(apart))
        chosen = f"FILTER(?g NOT IN ({hidden}))" if hidden else ""
        self.store.update(f"INSERT {{ ?s ?p ?o }} WHERE {{ GRAPH ?g {{ ?s ?p ?o }} {chosen} }}")

    def _drop(self, delta: Delta) -> None:
        self._hide(delta.head["graph"])
        self.store.remove_graph(ox.NamedNode(delta.head["graph"]))

    def _merge(self, graph: ox.NamedNode) -> None:
        self._shown.add(graph.value)
        self.store.extend(
            ox.Quad(quad.subject, quad.predicate, quad.object)
            for quad in self.store.quads_for_pattern(None, None, None, graph)
        )

    def _hide(self, graph: Iri) -> None:
        """Take its triples out of the default graph, but for those which another shown graph has."""
        self._shown.discard(graph)
        for quad in list(self.store.quads_for_pattern(None, None, None, ox.NamedNode(graph))):
            held = self.store.quads_for_pattern(quad.subject, quad.predicate, quad.object, None)
            names = (each.graph_name for each in held)
            if not any(isinstance(name, ox.NamedNode) and name.value in self._shown for name in names):
                self.store.remove(ox.Quad(quad.subject, quad.predicate, quad.object))
