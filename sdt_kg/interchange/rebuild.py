"""Graphs that a twin wrote → its entities and state, or what is missing from them or was changed.

Nothing inferred is believed: the rules run again over what is asserted, and what the graphs say was
inferred must be what they find. A change of an asserted figure alone gives another, equally whole
twin; only its content hash tells, so whoever knows that hash gives it.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import pyoxigraph as ox
import rdflib
from rdflib.graph import DATASET_DEFAULT_GRAPH_ID

from sdt_kg.annotating.annotate import TEE_GRAPH, annotate, tee_triples
from sdt_kg.entities import Entities, state_iri
from sdt_kg.errors import GraphError, StateError, UnknownEntityError
from sdt_kg.interchange.forms import Quads, stored
from sdt_kg.interchange.places import with_files_here
from sdt_kg.iri import SDT, TEE, Iri, graph_iri, local_name, model_iri
from sdt_kg.mechanism import Mechanism
from sdt_kg.numbers import so_many
from sdt_kg.state import State
from sdt_kg.store import MemoryStore, Triple, value_of
from sdt_kg.triples import Facts, checked_model
from sdt_kg.triples.to_mechanism import notes_of

_ASSERTED: Final = graph_iri("asserted", "")
_REMEDY: Final = "save the twin again: sdt graph KITCHEN --robot ROBOT -o FILE.nq"


def rebuilt(  # noqa: PLR0913 - what of the quads is meant, and what is known of them
    quads: Quads,
    environment: Iri | None,
    robots: Sequence[Iri] | None,
    *,
    state: Iri | None,
    hashes: Mapping[Iri, str],
    beside: Path | None,
) -> tuple[Entities, State]:
    """Entities and state of the twin whose graphs these are; see `Twin.from_quads`."""
    graphs = _Graphs(quads)
    entities = _entities(graphs, environment, robots, beside)
    _check_hashes(entities, hashes)
    return entities, _state(graphs, entities, state)


def rebuilt_entities(quads: Quads, environment: Iri, robots: Sequence[Iri], beside: Path | None) -> Entities:
    """Entities of these models, whatever states the graphs hold; see `Twin.from_quads`."""
    return _entities(_Graphs(quads), environment, robots, beside)


def _entities(
    graphs: "_Graphs", environment: Iri | None, robots: Sequence[Iri] | None, beside: Path | None
) -> Entities:
    environment = _environment(graphs, environment)
    chosen = sorted(graphs.models("Robot")) if robots is None else list(robots)
    store = MemoryStore()
    store.add(TEE_GRAPH, tee_triples())
    _check_constants(graphs, store)
    asserted: dict[Iri, Iri] = {}
    inferred: dict[Iri, tuple[Iri, ...]] = {}
    notes: list[str] = []
    for model, kind in [(environment, "Environment"), *((robot, "Robot") for robot in chosen)]:
        asserted[model] = _asserted(graphs, model, kind)
        triples = with_files_here(graphs.triples(asserted[model]), model, beside)
        mechanism = checked_model(triples, model, kind)
        store.add(asserted[model], triples)
        inferred[model] = tuple(annotate(store, model, asserted[model]))
        _check_inferred(graphs, store, model, inferred[model])
        notes += _notes(triples, model, mechanism)
    return Entities(store, environment, tuple(chosen), asserted, inferred, tuple(notes))


class _Graphs:
    """Named graphs of a store or a stream of quads, each read when it is asked for."""

    def __init__(self, quads: Quads) -> None:
        self._store = stored(quads)

    def names(self, prefix: str) -> list[Iri]:
        """Names of the graphs that begin like this, sorted."""
        named = (graph.value for graph in self._store.named_graphs() if isinstance(graph, ox.NamedNode))
        return sorted(name for name in named if name.startswith(prefix))

    def models(self, kind: str) -> list[Iri]:
        """Models of that kind: those whose own asserted graph says so."""
        kind_node = ox.NamedNode(SDT + kind)
        found = (model_iri(local_name(graph)) for graph in self.names(_ASSERTED))
        return [model for model in found if self._is(model, kind_node)]

    def _is(self, model: Iri, kind: ox.NamedNode) -> bool:
        graph = ox.NamedNode(graph_iri("asserted", local_name(model)))
        return any(self._store.quads_for_pattern(ox.NamedNode(model), None, kind, graph))

    def triples(self, graph: Iri) -> list[Triple]:
        """Triples of a named graph.

        Raises:
            GraphError: A blank node: no graph of a twin has one.
        """
        found: list[Triple] = []
        for quad in self._store.quads_for_pattern(None, None, None, ox.NamedNode(graph)):
            subject, value = quad.subject, quad.object
            if not isinstance(subject, ox.NamedNode) or not isinstance(value, ox.NamedNode | ox.Literal):
                raise GraphError(f"<{graph}> has a blank node or a quoted triple: {quad}", remedy=_REMEDY)
            found.append((subject.value, quad.predicate.value, value))
        return found


def _environment(graphs: _Graphs, given: Iri | None) -> Iri:
    found = graphs.models("Environment")
    if given is None and len(found) == 1:
        return found[0]
    if given is None:
        names = ", ".join(map(local_name, found)) or "none; a twin's named graphs are needed (.trig, .nq)"
        raise GraphError(
            f"the graphs hold {len(found)} kitchens: {names}",
            allowed="one",
            remedy="take a file of one; in Python, Twin.from_quads(quads, environment) says which is meant",
        )
    if given not in found:
        raise UnknownEntityError("kitchen in these graphs", local_name(given), map(local_name, found))
    return given


def _asserted(graphs: _Graphs, model: Iri, kind: str) -> Iri:
    if model not in graphs.models(kind):
        known = map(local_name, graphs.models(kind))
        raise UnknownEntityError(f"{kind.lower()} in these graphs", local_name(model), known)
    return graph_iri("asserted", local_name(model))


def _check_constants(graphs: _Graphs, store: MemoryStore) -> None:
    """That D_artic's figures are this version's; labels may differ, and of other classes more be known.

    What other classes ask for besides decides nothing about a twin: a verdict that is relative to one has
    the hash of that.
    """
    given, expected = set(graphs.triples(TEE_GRAPH)), set(store.triples(TEE_GRAPH))
    needed = _of_class(TEE + "D_artic", expected)
    lost = {each for each in expected - given if each[0] in needed}
    differing = sorted(_text(each) for each in lost | (given - expected) if each[1].startswith((TEE, SDT)))
    if differing:
        what = f"the constants of D_artic differ from this version's: {differing[0]}"
        raise GraphError(f"{what}, {so_many(len(differing), 'difference', 'differences')}", remedy=_REMEDY)


def _of_class(tee_class: Iri, triples: set[Triple]) -> set[Iri]:
    """The class, and whatever it says something with."""
    found, new = set[Iri](), {tee_class}
    while new:
        found |= new
        said = (each[2] for each in triples if each[0] in new)
        new = {term.value for term in said if isinstance(term, ox.NamedNode)} - found
    return found


def _check_inferred(graphs: _Graphs, store: MemoryStore, model: Iri, found: Sequence[Iri]) -> None:
    """What the rules find is what is there; `.../RULE/CONTENT` are copies, of the branches of a history."""
    prefix = graph_iri("inferred", f"{local_name(model)}/")
    what = f"what is inferred about '{local_name(model)}' is not what the rules of this version find"
    given = {graph for graph in graphs.names(prefix) if "/" not in graph.removeprefix(prefix)}
    for graph in sorted({*found, *given}):
        _expect(graphs, store, graph, what)


def _expect(graphs: _Graphs, store: MemoryStore, graph: Iri, what: str) -> None:
    """The graph says what the store's says.

    Raises:
        GraphError: It says more or less.
    """
    expected, given = set(store.triples(graph)), set(graphs.triples(graph))
    if expected == given:
        return
    lost, added = sorted(map(_text, expected - given)), sorted(map(_text, given - expected))
    differences = [f"without {lost[0]}" if lost else "", f"with {added[0]}" if added else ""]
    shown = " and ".join(each for each in differences if each)
    count = so_many(len(lost) + len(added), "difference", "differences")
    raise GraphError(f"{what}: <{graph}> {shown}, {count}", remedy=_REMEDY)


def _text(triple: Triple) -> str:
    subject, predicate, value = triple
    return f"'{local_name(subject)} {local_name(predicate)} {value_of(value)}'"


def _notes(triples: Iterable[Triple], model: Iri, mechanism: Mechanism) -> list[str]:
    name = mechanism.name
    facts = Facts(triples)
    assumed = (str(each) for kind in ("assumption", "baseAssumption") for each in facts.all(model, kind))
    notes = [f"{name}: {note}" for note in (*notes_of(facts, model), *assumed)]
    return notes + [
        f"{name}: joint '{joint.name}': {note}" for joint in mechanism.joints for note in joint.notes
    ]


def _check_hashes(entities: Entities, hashes: Mapping[Iri, str]) -> None:
    for model, expected in hashes.items():
        if model not in entities.asserted:
            raise UnknownEntityError("model", model, entities.asserted)
        found = entities.content_hash(model)
        if found != expected:
            raise GraphError(
                f"'{local_name(model)}' in these graphs has the content hash {found}", allowed=expected
            )


def _state(graphs: _Graphs, entities: Entities, given: Iri | None) -> State:
    names = graphs.names(graph_iri("state", local_name(entities.environment) + "/"))
    if not entities.coupling.joints and given in (None, state_iri(entities.environment, State())):
        return State()  # a graph without a triple is in no store
    if given is None and len(names) != 1:
        raise GraphError(
            f"the graphs hold {len(names)} states of '{local_name(entities.environment)}'",
            allowed="one, or the IRI of the graph that is meant",
        )
    graph = names[0] if given is None else given
    if graph not in names:
        raise UnknownEntityError("state in these graphs", graph, names)
    return _complete(graphs.triples(graph), graph, entities)


def _complete(triples: Iterable[Triple], graph: Iri, entities: Entities) -> State:
    """The state of every movable joint, which the graph's name is the hash of."""
    positions: dict[Iri, float] = {}
    for joint, predicate, term in triples:
        value = value_of(term)
        if predicate != SDT + "position" or not isinstance(value, float) or joint in positions:
            raise GraphError(f"<{graph}> holds more than one position for each joint", remedy=_REMEDY)
        positions[joint] = value
    state, start = State.of(positions), entities.coupling.start()
    if set(state) != set(start):
        odd = ", ".join(sorted(map(local_name, set(state) ^ set(start))))
        raise GraphError(f"<{graph}> lacks joints or has some that cannot move: {odd}", remedy=_REMEDY)
    if state_iri(entities.environment, state) != graph:
        raise GraphError(f"<{graph}> was changed: its name is not the hash of its positions", remedy=_REMEDY)
    try:
        complete = entities.coupling.moved(start, state)
    except StateError as error:
        raise GraphError(f"<{graph}> is no state of these entities: {error}", remedy=_REMEDY) from None
    if complete != state:
        raise GraphError(f"<{graph}> is no state of these entities: joints contradict each other")
    return state


def quads_of(dataset: rdflib.Dataset) -> Iterator[ox.Quad]:
    """Quads of an rdflib dataset's named graphs.

    Raises:
        GraphError: A blank node or a formula: no graph of a twin has one.
    """
    for subject, predicate, value, graph in dataset.quads():
        if isinstance(graph, rdflib.URIRef) and graph != DATASET_DEFAULT_GRAPH_ID:
            yield ox.Quad(_node(subject), _node(predicate), _term(value), _node(graph))


def _node(node: object) -> ox.NamedNode:
    if not isinstance(node, rdflib.URIRef):
        raise GraphError(f"{node!r} is no IRI", allowed="IRIs and literals", remedy=_REMEDY)
    return ox.NamedNode(str(node))


def _term(node: object) -> ox.NamedNode | ox.Literal:
    if not isinstance(node, rdflib.Literal):
        return _node(node)
    datatype = None if node.datatype is None else ox.NamedNode(str(node.datatype))
    if node.language is not None:
        return ox.Literal(str(node), language=node.language)
    return ox.Literal(str(node), datatype=datatype)
